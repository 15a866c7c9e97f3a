//! Transmission studies: the sum of the deflections that measurements of a touch report.

use bubbletouch::contact::{Press, Until, Workspace};
use bubbletouch::kinds::prelude::*;
use bubbletouch::sensing::{Ensemble, Projection};
use bubbletouch::signal::{Chain, SignalWorkspace};
use bubbletouch::study::{SignalSpec, StepSpec};
use ndarray::Array2;
use std::slice::from_ref;

study_file! {
pub struct TransmissionStudySpec {
    /// Table `[objects]`: the touched objects.
    objects: ObjectsSpec;
    /// Table `[skin]`: a single array of taxels.
    skin: SkinSpec;
    /// Table `[touches]`: poses and depths of the touches.
    touches: TouchesSpec;
    /// Table `[signal]`: the signal chain of the array.
    signal: SignalSpec;
    /// Table `[transmission]`: the measurements.
    transmission: TransmissionSpec;
} }

params! {
    /// Keys of `[transmission]`: the measurements.
    pub struct TransmissionSpec {
        /// Axis: ensemble from which the measurements are drawn.
        ensemble: Axis<Ensemble> => Any, Choice, Table;
        /// Number of measurements of a frame, at least 1.
        measurements: usize => COUNT, Choice, Never;
    }
}

row! {
/// Ensemble with which a touch is measured.
pub struct TransmissionConfiguration {
    /// Name of the touched object.
    object: String => Subject;
    /// Ensemble from which the measurements are drawn.
    ensemble: Ensemble => Choice;
} }

row! {
/// Measured sum of deflections.
pub struct Transmission {
    /// Mean over the touches of the sum of all measurements, metres.
    sum_m: f64 => Value(More) "sum of measurements" in "m": Linear;
} }

const TRANSMISSION: File<(TransmissionConfiguration, Transmission)> =
    File::new("transmission.csv", "Measured deflections", "");

pub struct TransmissionStudy {
    spec: TransmissionStudySpec,
    array: TaxelArray,
    touched: Vec<TouchedObject>,
    configurations: Vec<TransmissionConfiguration>,
}

impl Study for TransmissionStudy {
    const ABOUT: About = About {
        table: "transmission",
        words: "a study of the measured deflections",
    };
    const VERSION: &'static str = "1";
    const TABLES: TableFiles = TableFiles::always(&[&TRANSMISSION]);

    type Spec = TransmissionStudySpec;
    type Rows = Vec<(TransmissionConfiguration, Transmission)>;

    fn load(source: &Source) -> Result<Self> {
        let mut spec = TransmissionStudySpec::of(source)?;
        let check = source.check();
        check.keys("transmission", &spec.transmission, &Self::keys())?;
        check.keys("signal", &spec.signal, &Self::keys())?;
        check.steps(&spec.signal)?;
        let of_touches = (&spec.skin, &spec.touches);
        let (array, placement) = check.touches_of_one_array(&mut spec.objects, of_touches)?;
        let objects = load_objects(&spec.objects, source.packings.as_deref())?;
        let touched = draw_touches(objects, &placement, &Seed::new(spec.seed))?;
        let mut configurations = Vec::new();
        for of in &touched {
            for ensemble in spec.transmission.ensemble.values() {
                let object = of.object.name.clone();
                configurations.push(TransmissionConfiguration { object, ensemble });
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
        let (seed, patch) = (Seed::new(self.spec.seed), self.array.patch());
        let mut steps = Vec::new();
        for step in &self.spec.signal.steps {
            if let StepSpec::Error(error) = step {
                let strengths = error.about().strengths.iter();
                let axes = strengths.map(|strength| self.spec.signal.axes.get(strength.key));
                let strengths: Vec<f64> = axes
                    .map(|axis| axis.map_or(0.0, |axis| axis.values()[0]))
                    .collect();
                steps.push(error.step(&strengths, seed)?);
            }
        }
        let chain = Chain::new(&steps, patch)?;
        left.each("press", &self.configurations, |configuration| {
            let mut of = self.touched.iter();
            let of = of.find(|of| of.object.name == configuration.object);
            let of = of.expect("configurations are of these objects");
            let m = self.spec.transmission.measurements;
            let shape = self.array.shape();
            let projection = Projection::new(configuration.ensemble, shape, m, &seed)?;
            let model = from_ref(&of.object.model);
            let mut workspace = Workspace::new();
            let mut sum_m = 0.0;
            for (number, touch) in of.touches.iter().enumerate() {
                let pose = [touch.patch_from_object(&of.rests[touch.rest])];
                Press::new(patch, model, &pose, Until::Depth(touch.depth)).run(&mut workspace);
                let mut frame = workspace.deflections().to_vec();
                let of_touch = seed.numbered(number as u64);
                chain.apply(&mut frame, None, &of_touch, &mut SignalWorkspace::default());
                let frame = Array2::from_shape_vec((1, frame.len()), frame);
                sum_m += projection.measure(frame.expect("one row").view()).sum();
            }
            sum_m /= of.touches.len() as f64;
            Ok(vec![(configuration.clone(), Transmission { sum_m })])
        })
    }

    fn tables(&self, rows: Self::Rows) -> Result<Vec<Table>> {
        Ok(vec![TRANSMISSION.table(&rows)?])
    }

    fn charts(&self, tables: &[Table]) -> Vec<ChartSpec> {
        let title = "Sum of measurements by ensemble";
        vec![tables[0].chart("sum", title, ("sum_m", "ensemble"))]
    }
}
