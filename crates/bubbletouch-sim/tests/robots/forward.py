"""Forward kinematics of the robots beside this file, by an independent program: writes forward.csv.

Poses come from Pinocchio (https://stack-of-tasks.github.io/pinocchio). It takes every planar joint as one across its z axis;
the joint `slide` of rover.urdf, whose axis is another, is therefore replaced for it by a turned origin, a planar joint across z,
and a fixed joint that turns back; the turn is the shortest one from +z to the axis. It follows no chains of joints that mimic:
FOLLOWERS writes them out.

    python3 -m venv venv && venv/bin/pip install pin==4.1.0 numpy
    venv/bin/python crates/bubbletouch-sim/tests/robots/forward.py
"""

import csv
import pathlib

import numpy as np
import pinocchio as pin

HERE = pathlib.Path(__file__).parent
CASES = 6

# Joints in the order of each file, without fixed ones and those that mimic.
ROBOTS = {
    "six_axis": [(name, 1) for name in ["pan", "lift", "elbow", "wrist_1", "wrist_2", "wrist_3"]],
    "gripper": [("left", 1), ("probe", 1)],
    "rover": [("roam", 3), ("slide", 3), ("fly", 6), ("look", 1)],
}

# Positions of the joints that mimic, from those of the robot.
FOLLOWERS = {
    "gripper": {
        "right": lambda q: q[0],
        "right_tip": lambda q: -0.5 * q[0] + 0.07,
        "screw": lambda q: 0.025 * (-0.5 * q[0] + 0.07) + 0.001,
    }
}


def across_z(text):
    """rover.urdf with the joint `slide` as one that Pinocchio has."""
    axis = np.array([2.0, -1.0, 0.5])
    axis /= np.linalg.norm(axis)
    turn = pin.Quaternion.FromTwoVectors(np.array([0.0, 0.0, 1.0]), axis).toRotationMatrix()
    before = pin.rpy.rpyToMatrix(0.5, 0.0, 0.0) @ turn
    numbers = lambda matrix: " ".join(repr(float(x)) for x in pin.rpy.matrixToRpy(matrix))
    text = text.replace('<origin xyz="0 0 0.2" rpy="0.5 0 0"/>', f'<origin xyz="0 0 0.2" rpy="{numbers(before)}"/>')
    text = text.replace('<axis xyz="2 -1 0.5"/>', '<axis xyz="0 0 1"/>')
    text = text.replace('<child link="board"/>', '<child link="turned"/>')
    back = f"""<link name="turned"/><joint name="back" type="fixed"><parent link="turned"/><child link="board"/>
      <origin rpy="{numbers(turn.T)}"/></joint></robot>"""
    return text.replace("</robot>", back)


def configuration(model, joints, positions):
    """Pinocchio's coordinates: cosine and sine for endless turns, quaternions for free ones."""
    q = pin.neutral(model)
    at = 0
    for name, n in joints:
        mine = positions[at : at + n]
        at += n
        joint = model.joints[model.getJointId(name)]
        start = joint.idx_q
        if n == 6:
            quaternion = pin.Quaternion(pin.rpy.rpyToMatrix(np.array(mine[3:])))
            theirs = [*mine[:3], *quaternion.coeffs()]
        elif n == 3:
            theirs = [mine[0], mine[1], np.cos(mine[2]), np.sin(mine[2])]
        elif joint.nq == 2:
            theirs = [np.cos(mine[0]), np.sin(mine[0])]
        else:
            theirs = mine
        assert joint.nq == len(theirs), name
        q[start : start + joint.nq] = theirs
    return q


def rows():
    random = np.random.default_rng(2018)
    for robot, joints in ROBOTS.items():
        text = (HERE / f"{robot}.urdf").read_text()
        model = pin.buildModelFromXML(across_z(text) if robot == "rover" else text, False)
        data = model.createData()
        for case in range(CASES):
            n = sum(n for _, n in joints)
            positions = [0.0] * n if case == 0 else [round(x, 3) for x in random.uniform(-2, 2, n)]
            followers = FOLLOWERS.get(robot, {})
            all_joints = joints + [(name, 1) for name in followers]
            all_positions = positions + [follow(positions) for follow in followers.values()]
            pin.forwardKinematics(model, data, configuration(model, all_joints, all_positions))
            pin.updateFramePlacements(model, data)
            for frame in model.frames:
                if frame.type == pin.FrameType.BODY and frame.name not in ("universe", "turned"):
                    pose = data.oMf[model.getFrameId(frame.name, pin.FrameType.BODY)]
                    numbers = [*pose.translation, *pose.rotation.flatten()]
                    written = " ".join(repr(float(x)) for x in positions)
                    yield [robot, written, frame.name, " ".join(f"{x:.17g}" for x in numbers)]


with open(HERE / "forward.csv", "w", newline="") as file:
    writer = csv.writer(file, lineterminator="\n")
    writer.writerow(["robot", "positions", "link", "translation_and_rotation_by_rows"])
    writer.writerows(rows())
