"""Writer of MCAP files from recordings, for Foxglove, rerun and ROS tools. Needs the package mcap.

Messages are JSON; their times are the times of the scene in nanoseconds. The topics are:

- /NAME/points of a patch (foxglove.PointCloud): positions of the taxels at rest and the force on each taxel in the patch frame, as x, y, z, fx, fy,
  fz in single precision, and the pose of the patch in the world;
- /NAME/touch of a patch (bubbletouch.Touch): deflections, forces and the wrench, in double precision;
- /NAME/pose of an object (foxglove.PoseInFrame): pose in the world.
"""

from __future__ import annotations

import base64
import json
from collections.abc import Callable, Iterator
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np

from bubbletouch.recording import Floats, RecordedPatch, Recording

__all__ = ["write_mcap"]

_FLOAT32 = 7
_NUMBERS = {"type": "array", "items": {"type": "number"}}
_TIME = {"type": "object", "properties": {"sec": {"type": "integer"}, "nsec": {"type": "integer"}}}
_SCHEMAS = {
    "foxglove.PointCloud": {
        "timestamp": _TIME,
        "frame_id": {"type": "string"},
        "pose": {"type": "object"},
        "point_stride": {"type": "integer"},
        "fields": {"type": "array", "items": {"type": "object"}},
        "data": {"type": "string", "contentEncoding": "base64"},
    },
    "foxglove.PoseInFrame": {"timestamp": _TIME, "frame_id": {"type": "string"}, "pose": {"type": "object"}},
    "bubbletouch.Touch": {"timestamp": _TIME, "deflection_m": _NUMBERS, "force_n": _NUMBERS, "wrench": _NUMBERS},
}


def write_mcap(path: str | PathLike[str], recording: Recording) -> None:
    """Writes a recording to an MCAP file. Raises OSError if the file cannot be written, and ImportError without mcap."""
    from mcap.writer import Writer

    channels = list(_channels(recording))
    with Path(path).open("wb") as file:
        writer = Writer(file)
        writer.start(library="bubbletouch")
        names = {schema for _, schema, _ in channels}
        of_schema = {
            name: writer.register_schema(
                name, "jsonschema", json.dumps({"title": name, "type": "object", "properties": fields}).encode()
            )
            for name, fields in _SCHEMAS.items()
            if name in names
        }
        numbers = [writer.register_channel(topic, "json", of_schema[schema]) for topic, schema, _ in channels]
        for frame, time in enumerate(recording.time):
            at = round(1e9 * float(time))
            stamp = {"timestamp": {"sec": at // 10**9, "nsec": at % 10**9}}
            for number, (_, _, message) in zip(numbers, channels, strict=True):
                writer.add_message(number, at, json.dumps(stamp | message(frame)).encode(), at)
        writer.finish()


def _channels(recording: Recording) -> Iterator[tuple[str, str, Callable[[int], dict[str, Any]]]]:
    """Yields the topic, the schema and the message function of each channel. A message function returns the message of a frame, given the frame's
    number.
    """
    for name, felt in recording.patches.items():
        yield f"/{name}/points", "foxglove.PointCloud", _points(felt)
        yield f"/{name}/touch", "bubbletouch.Touch", _touch(felt)
    for name, poses in recording.objects.items():
        yield f"/{name}/pose", "foxglove.PoseInFrame", _in_world(poses)


def _points(felt: RecordedPatch) -> Callable[[int], dict[str, Any]]:
    """Returns the function that makes the message of a frame with the taxel positions and forces of a patch."""
    fields = [
        {"name": name, "offset": 4 * place, "type": _FLOAT32}
        for place, name in enumerate(("x", "y", "z", "fx", "fy", "fz"))
    ]
    centers, in_world = felt.patch.centers, _in_world(felt.pose)

    def message(frame: int) -> dict[str, Any]:
        points = np.concatenate([centers, felt.force3[frame]], axis=1).astype("<f4")
        data = base64.b64encode(points.tobytes()).decode()
        return in_world(frame) | {"point_stride": 24, "fields": fields, "data": data}

    return message


def _touch(felt: RecordedPatch) -> Callable[[int], dict[str, Any]]:
    """Returns the function that makes the message of a frame with the deflections, forces and wrench of a patch."""
    return lambda frame: {
        "deflection_m": felt.deflection[frame].ravel().tolist(),
        "force_n": felt.force[frame].ravel().tolist(),
        "wrench": felt.wrench[frame].tolist(),
    }


def _in_world(poses: Floats) -> Callable[[int], dict[str, Any]]:
    """Returns the function that makes the message of a frame from the poses (n, 7) of an object or patch in the world."""
    def message(frame: int) -> dict[str, Any]:
        x, y, z, qw, qx, qy, qz = poses[frame].tolist()
        turn = {"x": qx, "y": qy, "z": qz, "w": qw}
        return {"frame_id": "world", "pose": {"position": {"x": x, "y": y, "z": z}, "orientation": turn}}

    return message
