//! Keys of a reconstruction study, and its plan: the checked values in SI units.

use crate::inputs::keys::Acts;
use crate::inputs::params::named;
use crate::sensing::{Dictionary, Effort, Solver};
use crate::signal::{Noise, NoiseUnit, Quantity, SignalStep};
use crate::studies::prelude::*;
use crate::studies::recognition::spec::signal::SignalSpec;
use crate::studies::recognition::spec::study::SensingSpec;
use crate::studies::reconstruction::rows::*;
use crate::world::Grid;

study_file! {
pub struct ReconstructionStudySpec {
    /// Table `[objects]`: the touched objects.
    objects: ObjectsSpec;
    /// Table `[skin]`: a single array of taxels.
    skin: SkinSpec;
    /// Table `[touches]`: poses and depths of the touches.
    touches: TouchesSpec;
    /// Table `[signal]`: noise and processing of frames before compression. Smoothing is not allowed.
    signal: SignalSpec = SignalSpec::default();
    /// Table `[sensing]`: compression of frames into measurements.
    sensing: SensingSpec;
    /// Table `[reconstruction]`: solvers and dictionaries that reconstruct frames.
    reconstruction: ReconstructionSpec;
} }

/// Maximum value of the key `isometry_subsets`, the number of randomly drawn sets of atoms (supports) per size. All drawn supports are in memory together.
const MAX_SUBSETS: usize = 1_000_000;

/// Maximum value of the key `atoms` (number of atoms of a dictionary), more than any array has taxels. The minimum is two, because λ = √(2 ln k) vanishes for k
/// = 1 atom.
const MAX_ATOMS: usize = 100_000_000;

named!(Solver, Basis);

/// Condition of the limits of ℓ1 minimisation.
const OF_L1: &[Acts] = acts![ReconstructionSpec: |wanted| wanted.solver.values().contains(&Solver::L1)
    => "no solver of the study uses it", "l1 among reconstruction.solver, or no such key"];

params! {
    /// Keys of `[reconstruction]`: solvers and dictionaries that reconstruct frames.
    pub struct ReconstructionSpec {
        /// Axis: solver for the dictionary coefficients of a frame: `omp` (matching pursuit), `l1` (ℓ1 minimisation) or `lmmse` (linear estimation).
        solver: Axis<Solver> => Any, Choice, Table;
        /// Axis: dictionary (set of atoms that represent frames), `dct`, `haar`, `daubechies4` or `pca`.
        dictionary: Axis<Basis> => Any, Choice, Table;
        /// Maximum number of atoms of a dictionary, at least 2. The atoms with the most energy in the training frames are used. Default: all, or 256 for PCA.
        atoms: Option<usize> => Count(2, MAX_ATOMS), Choice, Never;
        /// Maximum number of atoms per frame that matching pursuit may select, at least 1. Default: 128.
        most_atoms: usize = Effort::default().most_atoms => COUNT, Choice, Never,
            acts: acts![ReconstructionSpec: |wanted| wanted.solver.values().contains(&Solver::Omp)
                => "no solver of the study uses it", "omp among reconstruction.solver, or no such key"];
        /// Regularisation parameter λ of the ℓ1 problem, as a multiple of the universal threshold σ a √(2 ln k), positive. Here σ is the noise standard deviation,
        /// a the root mean square norm of the columns of ΦΨ, and k the number of atoms. σ is at least 0.001 of the root mean square of the training frames.
        /// Default: 0.3.
        lambda_scale: f64 = Effort::default().lambda_scale => Positive, Choice, Never, acts: OF_L1;
        /// Duality gap at which the ℓ1 solver stops, relative to the minimised objective, positive. Default: 0.01.
        tolerance: f64 = Effort::default().tolerance => Positive, Choice, Never, acts: OF_L1;
        /// Maximum number of steps of the ℓ1 solver per frame, at least 1. `n_capped` counts the frames that need more, as frames without noise may do. Default:
        /// 2000.
        most_steps: usize = Effort::default().most_steps => COUNT, Choice, Never, acts: OF_L1;
        /// Fraction of the touches that are held out for testing, between 0 and 1. Default: 0.25.
        test_fraction: f64 = 0.25 => Part, Condition, Never;
        /// Axis: number of atoms in each randomly drawn set (support) for which isometry statistics are computed. Default: 8 and 32.
        isometry_sparsity: Axis<usize> = Axis::Many(vec![8, 32]) => COUNT, Condition, Table;
        /// Number of randomly drawn sets of atoms (supports) for each size in `isometry_sparsity`, at least 1. Default: 200.
        isometry_subsets: usize = 200 => Count(1, MAX_SUBSETS), Note, Never;
    }
}

impl ReconstructionSpec {
    /// Returns the limits of the solvers: atoms, regularisation, tolerance and steps.
    pub fn effort(&self) -> Effort {
        Effort {
            most_atoms: self.most_atoms,
            lambda_scale: self.lambda_scale,
            tolerance: self.tolerance,
            most_steps: self.most_steps,
        }
    }
}

/// Checked keys of a reconstruction study, converted to SI units.
#[derive(Clone, Debug)]
pub struct ReconstructionPlan {
    /// Specification of the study, with the keys, values and units of the study file.
    pub spec: ReconstructionStudySpec,
    /// Array of taxels that touches the objects.
    pub array: TaxelArray,
    /// Distribution from which the poses of touches are drawn.
    pub placement: Placement,
    /// Unit of the noise standard deviations.
    pub noise_unit: NoiseUnit,
    /// Noise standard deviations that the study compares, in `noise_unit`.
    pub noise: Vec<f64>,
    /// Dictionaries (sets of atoms that represent frames) that the study compares.
    pub dictionaries: Vec<Basis>,
}

impl ReconstructionPlan {
    /// Creates the plan of a study and checks all its keys.
    ///
    /// # Errors
    /// If a key is out of its range; the error names `place` (the file) and the first such key.
    pub fn new(place: &str, mut spec: ReconstructionStudySpec) -> Result<Self> {
        let check = Check { place };
        let of_touches = (&spec.skin, &spec.touches);
        let (array, placement) = check.touches_of_one_array(&mut spec.objects, of_touches)?;
        let (noise_unit, noise) = check.noise(&spec.signal, None)?;
        check.steps(&spec.signal)?;
        check.noise_is_last(&spec.signal)?;
        let reads_force = spec.signal.steps.contains(&StepSpec::Force);
        let of_force = "\"force\" among signal.steps beside it";
        check.used_keys(&spec, of_touches, (!reads_force).then_some(of_force))?;
        check.sensing(&spec.sensing, &array)?;
        check.drawn("sensing.ensemble", spec.sensing.ensemble.values())?;
        let allowed = "no such key: only studies of recognition use it";
        check.of_all_kinds("sensing", &spec.sensing, allowed)?;
        let wanted = &spec.reconstruction;
        check.keys(
            "reconstruction",
            wanted,
            keys_of::<ReconstructionStudySpec>(),
        )?;
        let dictionaries = check.dictionaries(wanted, array.grid())?;
        let axes = [
            spec.sensing.ensemble.values().len(),
            spec.sensing.measurements_on(array.n_taxels()).len(),
            noise.len(),
            dictionaries.len(),
            wanted.solver.values().len(),
        ];
        check.configurations(axes.iter().map(|&n| n as f64).product())?;
        Ok(Self {
            array,
            placement,
            noise_unit,
            noise,
            dictionaries,
            spec,
        })
    }

    /// Returns the signal steps with the given noise standard deviation, in `noise_unit`. If `noise` is `None`, the noise step is omitted.
    pub fn signal_steps(&self, noise: Option<f64>) -> Vec<SignalStep> {
        let unit = self.noise_unit;
        let steps = self.spec.signal.steps.iter();
        let steps = steps.filter_map(|step| match step {
            StepSpec::Force => Some(SignalStep::Force),
            StepSpec::Noise => noise.map(|std| SignalStep::Noise(Noise { std, unit })),
            // Steps that a reconstruction does not support were rejected earlier.
            _ => None,
        });
        steps.collect()
    }

    /// Returns the physical quantity of the noisy frames: deflection or force.
    pub fn quantity(&self) -> Quantity {
        match self.spec.signal.steps.contains(&StepSpec::Force) {
            true => Quantity::Force,
            false => Quantity::Deflection,
        }
    }

    /// Returns the numbers of measurements per frame that the study uses with an ensemble. The identity ensemble always measures all taxels.
    pub fn measurement_counts(&self, ensemble: Ensemble) -> Vec<usize> {
        let n = self.array.n_taxels();
        if ensemble == Ensemble::Identity {
            return vec![n];
        }
        let mut counts = self.spec.sensing.measurements_on(n);
        counts.sort_unstable();
        counts.dedup();
        counts
    }

    /// Returns the measurement matrix of an ensemble with `m` measurements per frame.
    pub(super) fn projection(&self, ensemble: Ensemble, m: usize) -> Result<Projection> {
        let seed = Seed::new(self.spec.seed).named("projection").numbered(0);
        Projection::new(ensemble, self.array.shape(), m, &seed)
    }

    /// Returns a list with one empty slot per dictionary; each slot is computed once and shared by all threads.
    pub(super) fn of_each_dictionary<T>(&self) -> Vec<Shared<T>> {
        let each = self.dictionaries.iter();
        each.map(|_| Shared::default()).collect()
    }

    /// Returns the index of a dictionary in the plan's list of dictionaries.
    pub(super) fn place_of(&self, basis: Basis) -> usize {
        let place = self.dictionaries.iter().position(|&known| known == basis);
        place.expect("configurations have the dictionaries of their plan")
    }

    /// Returns all configurations, ordered by ensemble and number of measurements. The numbers of atoms are set later, when the dictionaries are computed.
    pub fn configurations(&self) -> Vec<ReconstructionConfiguration> {
        let n_taxels = self.array.n_taxels() as f64;
        let mut configurations = Vec::new();
        nested! {
            ensemble in self.spec.sensing.ensemble.values();
            measurements in self.measurement_counts(ensemble);
            &noise_std in &self.noise;
            &dictionary in &self.dictionaries;
            solver in self.spec.reconstruction.solver.values();
            configurations.push(ReconstructionConfiguration {
                configuration: configurations.len(),
                noise_std,
                noise_unit: self.noise_unit,
                ensemble,
                measurements,
                ratio: n_taxels / measurements as f64,
                dictionary,
                atoms: 0,
                solver,
            })
        }
        configurations
    }
}

impl Check<'_> {
    /// Returns an error if a signal step follows the noise. Solvers assume independent noise on every taxel and need a clean frame for comparison.
    fn noise_is_last(&self, signal: &SignalSpec) -> Result<()> {
        let refuse = |key, given: &str, allowed| Err(self.error(key, given, allowed));
        if signal.axes.get("smoothing_mm").is_some() {
            return refuse(
                "signal.smoothing_mm",
                "smoothing before reconstruction",
                "no smoothing: solvers take the noise of taxels to be independent",
            );
        }
        let mut steps = signal.steps.iter();
        if let Some(step) = steps.find(|step| matches!(step, StepSpec::Error(_))) {
            return refuse(
                "signal.steps",
                &format!("\"{}\" before reconstruction", step.word()),
                "force and noise: solvers take taxels to differ from the truth by independent noise alone",
            );
        }
        let place = |step| signal.steps.iter().position(|s| *s == step);
        match (place(StepSpec::Force), place(StepSpec::Noise)) {
            (Some(force), Some(noise)) if force > noise => refuse(
                "signal.steps",
                "force after noise",
                "noise after force: solvers take noise to be Gaussian, and force cuts it at zero",
            ),
            _ => Ok(()),
        }
    }

    fn dictionaries(&self, wanted: &ReconstructionSpec, grid: &Grid) -> Result<Vec<Basis>> {
        let bases = wanted.dictionary.values();
        for &basis in bases.iter().filter(|&&basis| basis != Basis::Pca) {
            Dictionary::complete(
                basis,
                ImageShape {
                    ny: grid.ny,
                    nx: grid.nx,
                },
            )
            .map_err(|error| {
                let given = format!("{basis:?} ({error})");
                self.error("reconstruction.dictionary", given, "a basis of this array")
            })?;
        }
        Ok(bases)
    }
}
