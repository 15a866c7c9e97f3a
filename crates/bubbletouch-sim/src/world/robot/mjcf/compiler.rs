//! Settings of the elements `<compiler>`.

use crate::error::Result;
use crate::text::xml::Element;
use std::f64::consts::PI;

/// Settings that determine how angles, limits and file names of a model are read.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Compiler {
    /// Radians per unit of angle: π/180 for degrees, the default, and 1 for radians.
    pub angle: f64,
    /// Axes of three Euler angles. The axes x, y and z turn with the body; X, Y and Z are fixed.
    pub euler_sequence: String,
    /// Whether a joint with a range and without `limited` is limited.
    pub has_auto_limits: bool,
    /// Whether the frames of bodies with a free joint are moved to the frames of their inertia.
    pub aligns_free: bool,
    /// Folder of mesh files, relative to the folder of the model.
    pub mesh_folder: String,
    /// Whether folders in the names of mesh files are removed.
    pub strips_paths: bool,
}

impl Compiler {
    /// Reads all `<compiler>` elements of a model; later ones replace attributes of earlier ones.
    ///
    /// # Errors
    /// If an attribute is invalid, or the model has global coordinates, which MuJoCo no longer reads.
    pub fn read(root: Element) -> Result<Self> {
        let mut compiler = Self {
            angle: PI / 180.0,
            euler_sequence: "xyz".to_owned(),
            has_auto_limits: true,
            aligns_free: false,
            mesh_folder: String::new(),
            strips_paths: false,
        };
        for element in root.children("compiler") {
            element.check_attributes(
                "autolimits boundmass boundinertia settotalmass balanceinertia strippath coordinate angle fitaabb eulerseq meshdir texturedir \
                 discardvisual convexhull usethread fusestatic inertiafromgeom inertiagrouprange exactmeshinertia assetdir alignfree saveinertial",
            )?;
            if element.attribute("coordinate") == Some("global") {
                let allowed =
                    "local coordinates: MuJoCo 2.3.3 converts a model when it loads and saves it";
                return Err(element.refuse("`coordinate` \"global\"", allowed));
            }
            let angle = element.one_of("angle", &[("degree", PI / 180.0), ("radian", 1.0)])?;
            compiler.angle = angle.unwrap_or(compiler.angle);
            if let Some(sequence) = element.attribute("eulerseq") {
                let is_axis = |axis| "xyzXYZ".contains(axis);
                if sequence.len() != 3 || !sequence.chars().all(is_axis) {
                    let given = format!("`eulerseq` \"{sequence}\"");
                    return Err(element.refuse(given, "three of x, y, z, X, Y, Z"));
                }
                compiler.euler_sequence = sequence.to_owned();
            }
            for (name, flag) in [
                ("autolimits", &mut compiler.has_auto_limits),
                ("alignfree", &mut compiler.aligns_free),
                ("strippath", &mut compiler.strips_paths),
            ] {
                let given = element.one_of(name, &[("false", false), ("true", true)])?;
                *flag = given.unwrap_or(*flag);
            }
            let folder = element.attribute("meshdir");
            if let Some(folder) = folder.or(element.attribute("assetdir")) {
                compiler.mesh_folder = folder.to_owned();
            }
        }
        Ok(compiler)
    }

    /// Returns the path of a mesh file relative to the folder of the model.
    pub fn mesh_path(&self, file: &str) -> String {
        let file = match self.strips_paths {
            true => file.rsplit(['/', '\\']).next().unwrap_or(file),
            false => file,
        };
        let folder = self.mesh_folder.trim_end_matches('/');
        match self.mesh_folder.is_empty() || file.starts_with('/') {
            true => file.to_owned(),
            false => format!("{folder}/{file}"),
        }
    }
}
