//! One wall, several attempts: the surface as asked with each mesher, then a finer and a coarser one.

use std::time::Instant;

use super::interior::interior_points;
use super::{MesherFailure, TetMesher, TetQuality, TetSettings, check};
use crate::math::{Reason, Rejected, Room};
use crate::mesh::{TetMesh, WallSurfaces};
use crate::surface::{TriangleMesh, intersecting_pairs};

/// The edges tried, as shares of the one asked for.
///
/// # Decisions
/// All meshers try the surface as asked before another edge is tried: a mesher fails within a second, and a result at the
/// edge asked for is comparable with its siblings. Finer comes before coarser, because most surfaces that fail
/// are too coarse for a fold.
const EDGES: [f64; 4] = [1.0, 0.8, 0.6, 1.3];

/// One rung of the ladder, climbed or slipped off.
#[derive(Clone, Debug, PartialEq)]
pub struct Attempt {
    /// The mesher's name; `wall` where there was no surface to give it.
    pub mesher: String,
    /// Edge length of the surfaces, mm.
    pub edge: f64,
    /// What it took, s of the clock.
    pub seconds: f64,
    /// Why it failed, if it did.
    pub failure: Option<AttemptFailure>,
}

/// Why a rung gave no mesh, or one that is only taken when there is no better.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum AttemptFailure {
    /// There is no wall at this edge.
    #[error("{0}")]
    Wall(Rejected),
    /// The surfaces pass through themselves or each other: no mesher was asked.
    #[error("{pairs} pairs of triangles of the wall's surfaces pass through each other")]
    Crossing {
        /// Pairs of triangles.
        pairs: usize,
    },
    /// The mesher failed, or its answer is wrong.
    #[error("{0}")]
    Mesher(MesherFailure),
    /// The tetrahedra fill the wall, but badly.
    #[error("a dihedral angle is {degrees:.2} degrees")]
    Poor {
        /// The smallest dihedral angle, degrees.
        degrees: f64,
    },
}

/// A wall filled with tetrahedra.
#[derive(Clone, Debug, PartialEq)]
pub struct Filled {
    /// The tetrahedra.
    pub mesh: TetMesh,
    /// Their figures.
    pub quality: TetQuality,
    /// Who made them.
    pub mesher: String,
    /// Edge length of the surfaces between which they lie, mm.
    pub edge: f64,
    /// All attempts in their order.
    pub attempts: Vec<Attempt>,
}

/// A wall that stays empty.
#[derive(Clone, Debug, PartialEq)]
pub enum Unfilled {
    /// No rung of the ladder held.
    Rejected {
        /// The wall's own reason where no mesher was ever asked, else `no_tetrahedra`; the violation is 1.
        rejected: Rejected,
        /// All attempts in their order.
        attempts: Vec<Attempt>,
    },
    /// A mesher could not be run: a fault of the machine, in one line.
    Machine(String),
}

/// Tetrahedra between the `surfaces` of a wall, which are given for an edge length in mm, by the first of the `meshers` that succeeds.
///
/// # Errors
/// [`Unfilled`] when none does at any edge length, or one cannot be run.
pub fn filled_wall(
    surfaces: &dyn Fn(f64) -> Result<WallSurfaces, Rejected>,
    meshers: &[&dyn TetMesher],
    settings: &TetSettings,
) -> Result<Filled, Unfilled> {
    let mut attempts = Vec::new();
    let mut poor: Option<Filled> = None;
    for share in EDGES {
        let settings = TetSettings { edge: share * settings.edge, ..*settings };
        let start = Instant::now();
        let wall = match crossing_free(surfaces(settings.edge)) {
            Ok(wall) => wall,
            Err(failure) => {
                attempts.push(attempt("wall", settings.edge, start, Some(failure)));
                continue;
            }
        };
        for mesher in meshers {
            let start = Instant::now();
            let (failure, filled) = match filled(*mesher, &wall, &settings) {
                Ok(mesh) => {
                    let quality = TetQuality::of(&mesh, &wall);
                    let degrees = quality.dihedral_min;
                    let is_poor = degrees < settings.dihedral_min;
                    let filled = Filled {
                        mesh,
                        quality,
                        mesher: mesher.name().to_owned(),
                        edge: settings.edge,
                        attempts: Vec::new(),
                    };
                    (is_poor.then_some(AttemptFailure::Poor { degrees }), Some(filled))
                }
                Err(MesherFailure::Machine(what)) => return Err(Unfilled::Machine(what)),
                Err(failure) => (Some(AttemptFailure::Mesher(failure)), None),
            };
            let is_good = failure.is_none();
            attempts.push(attempt(mesher.name(), settings.edge, start, failure));
            match filled {
                Some(filled) if is_good => return Ok(Filled { attempts, ..filled }),
                Some(filled) if better(&filled, poor.as_ref()) => poor = Some(filled),
                _ => {}
            }
        }
    }
    match poor {
        Some(filled) => Ok(Filled { attempts, ..filled }),
        None => Err(Unfilled::Rejected { rejected: rejected(&attempts), attempts }),
    }
}

/// Tetrahedra that fill `wall` as asked, checked.
fn filled(
    mesher: &dyn TetMesher,
    wall: &WallSurfaces,
    settings: &TetSettings,
) -> Result<TetMesh, MesherFailure> {
    let mesh = mesher.tetrahedra(wall, &[], settings)?;
    check(&mesh, wall)?;
    let interior = interior_points(&mesh, settings.layers, settings.edge);
    if interior.is_empty() {
        return Ok(mesh);
    }
    let mesh = mesher.tetrahedra(wall, &interior, settings)?;
    check(&mesh, wall)?;
    Ok(mesh)
}

fn crossing_free(wall: Result<WallSurfaces, Rejected>) -> Result<WallSurfaces, AttemptFailure> {
    let wall = wall.map_err(AttemptFailure::Wall)?;
    let pairs = intersecting_pairs(&both(&wall)).len();
    if pairs > 0 { Err(AttemptFailure::Crossing { pairs }) } else { Ok(wall) }
}

/// Both surfaces as one, without common vertices.
fn both(wall: &WallSurfaces) -> TriangleMesh {
    let WallSurfaces { outer, chamber } = wall;
    let shift = outer.positions.len() as u32;
    let shifted = chamber.triangles.iter().map(|t| t.map(|v| v + shift));
    TriangleMesh {
        positions: outer.positions.iter().chain(&chamber.positions).copied().collect(),
        triangles: outer.triangles.iter().copied().chain(shifted).collect(),
    }
}

fn attempt(mesher: &str, edge: f64, start: Instant, failure: Option<AttemptFailure>) -> Attempt {
    let seconds = start.elapsed().as_secs_f64();
    Attempt { mesher: mesher.to_owned(), edge, seconds, failure }
}

fn better(this: &Filled, that: Option<&Filled>) -> bool {
    that.is_none_or(|that| this.quality.dihedral_min > that.quality.dihedral_min)
}

fn rejected(attempts: &[Attempt]) -> Rejected {
    let failures = || attempts.iter().filter_map(|attempt| attempt.failure.as_ref());
    let walls: Vec<&Rejected> = failures()
        .filter_map(|failure| match failure {
            AttemptFailure::Wall(rejected) => Some(rejected),
            _ => None,
        })
        .collect();
    if let [first, ..] = walls[..]
        && walls.len() == attempts.len()
    {
        return first.clone();
    }
    let first = attempts.iter().zip(failures()).next();
    let first = first.map_or(String::new(), |(attempt, failure)| {
        format!(", the first of {} at {:.2} mm: {failure}", attempt.mesher, attempt.edge)
    });
    let detail = format!("{} attempts failed{first}", attempts.len());
    Rejected::new(Room::Mesh, Reason::NoTetrahedra, detail, 1.0)
}

#[cfg(test)]
mod tests {
    use std::cell::Cell;
    use std::sync::atomic::{AtomicUsize, Ordering};

    use super::*;
    use crate::math::Vec3;
    use crate::mesh::tetrahedra::TetDefect;
    use crate::mesh::tetrahedra::test_walls::{crossing, of_prisms, spheres};

    /// A mesher that fails as often as it has failures, then fills the wall with prisms.
    struct Prisms {
        failures: Vec<MesherFailure>,
        asked: AtomicUsize,
    }

    impl Prisms {
        fn after(failures: &[MesherFailure]) -> Self {
            Self { failures: failures.to_vec(), asked: AtomicUsize::new(0) }
        }
    }

    impl TetMesher for Prisms {
        fn name(&self) -> &str {
            "prisms"
        }

        fn tetrahedra(
            &self,
            wall: &WallSurfaces,
            _: &[Vec3],
            _: &TetSettings,
        ) -> Result<TetMesh, MesherFailure> {
            let asked = self.asked.fetch_add(1, Ordering::Relaxed);
            self.failures
                .get(asked)
                .map_or_else(|| Ok(of_prisms(wall)), |failure| Err(failure.clone()))
        }
    }

    fn sphere_wall(_: f64) -> Result<WallSurfaces, Rejected> {
        Ok(spheres(10.0, 8.0, 2))
    }

    const CRASH: MesherFailure = MesherFailure::Crashed { signal: 11, words: String::new() };
    const HANG: MesherFailure = MesherFailure::TimedOut { seconds: 1.0 };

    #[test]
    fn the_first_mesher_that_succeeds_is_taken() {
        let meshers = [Prisms::after(&[CRASH, HANG]), Prisms::after(&[HANG])];
        let [first, second] = &meshers;
        let asked = Cell::new(0);
        let surfaces = |edge| {
            asked.set(asked.get() + 1);
            sphere_wall(edge)
        };
        let filled = filled_wall(&surfaces, &[first, second], &TetSettings::default()).unwrap();
        let failures: Vec<_> = filled.attempts.iter().map(|a| a.failure.clone()).collect();
        let mesher = |failure| Some(AttemptFailure::Mesher(failure));
        assert_eq!(failures, [mesher(CRASH), mesher(HANG), mesher(HANG), None]);
        let edges: Vec<f64> = filled.attempts.iter().map(|a| a.edge).collect();
        assert_eq!(edges, [2.0, 2.0, 1.6, 1.6]);
        assert_eq!((filled.edge, asked.get()), (1.6, 2));
        check(&filled.mesh, &spheres(10.0, 8.0, 2)).unwrap();
    }

    #[test]
    fn a_wrong_answer_is_a_failure_like_others() {
        // Prisms fill the wall between their own triangles, not between others.
        let mesher = Prisms::after(&[]);
        struct Other<'a>(&'a Prisms);
        impl TetMesher for Other<'_> {
            fn name(&self) -> &str {
                "other"
            }
            fn tetrahedra(
                &self,
                _: &WallSurfaces,
                interior: &[Vec3],
                settings: &TetSettings,
            ) -> Result<TetMesh, MesherFailure> {
                self.0.tetrahedra(&spheres(9.0, 7.0, 2), interior, settings)
            }
        }
        let filled =
            filled_wall(&sphere_wall, &[&Other(&mesher), &mesher], &TetSettings::default())
                .unwrap();
        assert!(matches!(
            filled.attempts[0].failure,
            Some(AttemptFailure::Mesher(MesherFailure::Wrong(TetDefect::OtherVolume { .. })))
        ));
        assert_eq!(filled.mesher, "prisms");
    }

    /// A flat wall is taken only after all rungs.
    #[test]
    fn a_poor_mesh_is_better_than_none() {
        let thin = |_| Ok(spheres(10.0, 9.99, 2));
        let filled = filled_wall(&thin, &[&Prisms::after(&[])], &TetSettings::default()).unwrap();
        assert_eq!(filled.attempts.len(), EDGES.len());
        assert!(filled.quality.dihedral_min < 1.0);
        assert!(matches!(filled.attempts[0].failure, Some(AttemptFailure::Poor { .. })));
    }

    #[test]
    fn when_all_fail_the_wall_is_rejected_with_the_first_cause() {
        let settings = TetSettings::default();
        let rejected = |surfaces: &dyn Fn(f64) -> Result<WallSurfaces, Rejected>,
                        mesher: &Prisms| {
            match filled_wall(surfaces, &[mesher], &settings).unwrap_err() {
                Unfilled::Rejected { rejected, attempts } => (rejected, attempts.len()),
                Unfilled::Machine(what) => panic!("{what}"),
            }
        };
        let hangs = Prisms::after(&[HANG, CRASH, CRASH, CRASH]);
        let (why, attempts) = rejected(&sphere_wall, &hangs);
        let detail =
            "4 attempts failed, the first of prisms at 2.00 mm: still running after 1 s".to_owned();
        assert_eq!(why, Rejected::new(Room::Mesh, Reason::NoTetrahedra, detail, 1.0));
        assert_eq!(attempts, 4);

        let unused = Prisms::after(&[]);
        let (why, attempts) = rejected(&|_| Ok(crossing()), &unused);
        assert!(why.detail.contains("pass through each other"), "{why}");
        assert_eq!((attempts, unused.asked.load(Ordering::Relaxed)), (4, 0));

        let closed = || Rejected::new(Room::Surface, Reason::ChamberClosed, String::new(), 0.2);
        assert_eq!(rejected(&|_| Err(closed()), &unused).0, closed());
    }

    #[test]
    fn a_fault_of_the_machine_ends_the_climb() {
        let absent = Prisms::after(&[MesherFailure::Machine("no program".to_owned())]);
        let unfilled = filled_wall(&sphere_wall, &[&absent], &TetSettings::default());
        assert_eq!(unfilled.unwrap_err(), Unfilled::Machine("no program".to_owned()));
    }
}
