//! Saturation studies: the fraction of the touches of an object that push taxels to the end of their stroke. This small kind of study is the example of
//! `guide/adding.md`.

use bubbletouch::contact::{Press, Until, Workspace};
use bubbletouch::kinds::prelude::*;
use std::slice::from_ref;

study_file! {
pub struct SaturationStudySpec {
    /// Table `[objects]`: the touched objects.
    objects: ObjectsSpec;
    /// Table `[skin]`: a single array of taxels.
    skin: SkinSpec;
    /// Table `[touches]`: poses and depths of the touches.
    touches: TouchesSpec;
    /// Table `[saturation]`: which touches count as saturated.
    saturation: SaturationSpec;
} }

params! {
    /// Keys of `[saturation]`: which touches count as saturated.
    pub struct SaturationSpec {
        /// Axis: number of taxels at the end of their stroke from which a touch counts as saturated, at least 1.
        n_taxels: Axis<usize> => COUNT, Condition, Table;
    }
}

row! {
/// Configuration of a saturation study.
pub struct SaturationConfiguration {
    /// Name of the touched object.
    object: String => Subject;
    /// Number of taxels at the end of their stroke from which a touch counts as saturated.
    n_taxels: usize => Condition "taxels at their stroke": Linear;
} }

row! {
/// Saturated touches. A row of `saturation.csv` is a [`SaturationConfiguration`] followed by a `Saturation`.
pub struct Saturation {
    /// Fraction of the touches that are saturated, 0 to 1.
    saturated: f64 => Value(Less) "saturated touches": Share;
} }

const SATURATION: File<(SaturationConfiguration, Saturation)> =
    File::new("saturation.csv", "Saturated touches", "");

/// Saturation study: its keys, its array, its objects with their touches, and its configurations.
pub struct SaturationStudy {
    spec: SaturationStudySpec,
    array: TaxelArray,
    touched: Vec<TouchedObject>,
    configurations: Vec<SaturationConfiguration>,
}

impl Study for SaturationStudy {
    const ABOUT: About = About {
        table: "saturation",
        words: "a study of saturated touches",
    };
    const VERSION: &'static str = "1";
    const TABLES: TableFiles = TableFiles::always(&[&SATURATION]);

    const CHARTS: &'static [Chart] = &[Chart {
        table: SATURATION.name(),
        name: "saturated",
        title: "Saturated touches by the number of taxels at their stroke",
        x: "n_taxels",
        y: "saturated",
        lines: &["object"],
        ..Chart::LINES
    }];

    type Spec = SaturationStudySpec;
    type Rows = Vec<(SaturationConfiguration, Saturation)>;

    fn load(source: &Source) -> Result<Self> {
        let mut spec = SaturationStudySpec::of(source)?;
        source.replace_objects(&mut spec.objects);
        let check = source.check();
        check.keys("saturation", &spec.saturation, &Self::keys())?;
        let of_touches = (&spec.skin, &spec.touches);
        let (array, placement) = check.touches_of_one_array(&mut spec.objects, of_touches)?;
        check.used_keys(&spec, of_touches, Some("no such key"))?;
        let objects = load_objects(&spec.objects, source.packings.as_deref())?;
        let touched = draw_touches(objects, &placement, &Seed::new(spec.seed))?;
        let mut configurations = Vec::new();
        for of in &touched {
            for n_taxels in spec.saturation.n_taxels.values() {
                let object = of.object.name.clone();
                configurations.push(SaturationConfiguration { object, n_taxels });
            }
        }
        Ok(Self {
            spec,
            array,
            touched,
            configurations,
        })
    }

    fn facts(&self) -> Result<Facts> {
        Ok(Facts::new(&self.spec, objects_content(&self.spec.objects)?))
    }

    fn scale(&self) -> Scale {
        Scale {
            objects: self.touched.len().to_string(),
            touches: "all of each object in each configuration".to_owned(),
            n_configurations: self.configurations.len(),
            ..Scale::default()
        }
    }

    fn work_items(&self) -> Vec<WorkItem> {
        let configurations = self.configurations.iter().map(|of| (of, ()));
        work_items_of::<Self, _, _>(&self.spec, configurations)
    }

    fn measure(&self, left: &PendingItems<Self::Rows>) -> Result<()> {
        left.each("press", &self.configurations, |configuration| {
            let mut of = self.touched.iter();
            let of = of.find(|of| of.object.name == configuration.object);
            let of = of.expect("configurations are of these objects");
            let (patch, model) = (self.array.patch(), from_ref(&of.object.model));
            let mut workspace = Workspace::new();
            let saturated = of.touches.iter().filter(|touch| {
                let pose = [touch.patch_from_object(&of.rests[touch.rest])];
                let press = Press::new(patch, model, &pose, Until::Depth(touch.depth));
                let contact = press.run(&mut workspace).unwrap();
                contact.is_some_and(|contact| contact.n_saturated >= configuration.n_taxels)
            });
            let saturated = saturated.count() as f64 / of.touches.len() as f64;
            Ok(vec![(configuration.clone(), Saturation { saturated })])
        })
    }

    fn tables(&self, rows: Self::Rows) -> Result<Vec<Table>> {
        Ok(vec![SATURATION.table(&rows)?])
    }
}
