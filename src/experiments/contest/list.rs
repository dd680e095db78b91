//! The experiments, by the sections of the paper.

use super::compared::{FIGURES, OF_TREES};
use super::experiment::{Among, Comparison, Expectation, Experiment, Families};
use super::kinds::BUILDINGS;
use super::variants::{
    OfBase, SPATIAL_OFF, adaptive, auxiliary_trees, bases, bucket_sort, changed, constant, hunt, presplit,
    spatial_off, triangle_counts,
};
use super::{grid, methods, order};
use crate::report::figures::Figure;

/// All of them.
pub const EXPERIMENTS: &[Experiment] = &[
    Experiment {
        name: "construction-speed",
        section: "5.1",
        about: "Build times of the paper's eight methods",
        paper: "Embree Morton builds fastest, usually followed by Hunt-50, AAC, Embree SAH, Hunt-500 and Embree Fast-Spatial; \
                PHR-Fast is between Embree Morton and Hunt-50, PHR-HQ between Embree SAH and Hunt-500 and takes half the time \
                of Embree Fast-Spatial; on larger scenes both take about 20 % less time than Hunt-50 and Hunt-500, for trees \
                that are slightly better",
        caveat: "Large scenes: a million triangles and more. Scans: single smooth surfaces (statue, bunny_144k, igea, \
                 brain_icbm152, buddha-like), for scenes of simple structure, in which both take about as long as Hunt.",
        entrants: methods::names,
        comparisons: methods::builds,
        figures: FIGURES,
        families: None,
        more: Some(order::of_builds),
    },
    Experiment {
        name: "trace-speed",
        section: "5.2",
        about: "Trace times of the paper's eight methods",
        paper: "Embree Fast-Spatial traces fastest; PHR-HQ follows closely in half of the scenes and is 10 to 20 % slower in \
                four of nine; PHR-Fast is between Embree Morton and Embree SAH",
        caveat: "",
        entrants: methods::names,
        comparisons: methods::traces,
        figures: FIGURES,
        families: None,
        more: Some(order::of_traces),
    },
    Experiment {
        name: "spatial-splits",
        section: "5.3",
        about: "Trees without spatial splits, relative to those with them",
        paper: "spatial splits make traces 2 to 20 % faster (2 to 25 % slower without them), most in large scenes of primitives \
                of many sizes",
        caveat: "Buildings: all scenes but the scans and the car.",
        entrants: || with_bases(spatial_off()),
        comparisons: || {
            let slower = Expectation {
                says: "traces take 2 to 25 % longer without spatial splits",
                figure: Figure::Trace,
                range: (1.02, 1.25),
                among: Among::All,
            };
            let in_buildings = Expectation {
                says: "they are slower in buildings",
                range: (1.0, f64::INFINITY),
                among: BUILDINGS,
                ..slower
            };
            compared(spatial_off(), &[slower, in_buildings])
        },
        figures: FIGURES,
        families: None,
        more: None,
    },
    Experiment {
        name: "grid",
        section: "5.4",
        about: "Build time against steps and trace time over alpha and delta of equation 2",
        paper: "PHR-Fast (0.5, 6) and PHR-HQ (0.55, 9) are about on the front of all scenes; in San Miguel and Power Plant \
                (0.5, 7) builds about 35 % faster than PHR-HQ and traces about 3 % faster; in Conference and Hairball \
                (0.5, 5) builds 9 and 33 % faster than PHR-Fast and traces as fast",
        caveat: "",
        entrants: grid::variants,
        comparisons: grid::comparisons,
        figures: FIGURES,
        families: Some(grid::families),
        more: Some(grid::findings),
    },
    Experiment {
        name: "cost-counts",
        section: "4.2",
        about: "Triangle counts in equations 1 and 3, relative to node counts",
        paper: "numbers of nodes give slightly better trees than numbers of triangles in most scenes, by a few percent",
        caveat: "Splits by triangle counts are found in plain code: their build times say nothing and are left out.",
        entrants: || with_bases(triangle_counts()),
        comparisons: || {
            let slower = Expectation {
                says: "trees by triangle counts trace slower",
                figure: Figure::Trace,
                range: (1.0, f64::INFINITY),
                among: Among::All,
            };
            let dearer = Expectation {
                says: "trees by triangle counts have a higher SAH cost",
                figure: Figure::Cost,
                ..slower
            };
            compared(triangle_counts(), &[dearer, slower])
        },
        figures: OF_TREES,
        families: None,
        more: None,
    },
    Experiment {
        name: "constant-cut",
        section: "4.3",
        about: "Cuts of constant length, relative to cuts by the adaptive threshold, without spatial splits",
        paper: "the adaptive threshold leads to consistently better results than a constant length: on larger scenes about \
                20 % less build time and slightly better trees",
        caveat: "Spatial splits are off on both sides, so that the rule of refinement alone differs.",
        entrants: || {
            let cuts = adaptive().into_iter().chain(constant()).map(|(_, name)| name);
            bases().into_iter().chain(cuts).collect()
        },
        comparisons: || {
            let longer = Expectation {
                says: "a constant length builds more slowly",
                figure: Figure::Build,
                range: (1.0, f64::INFINITY),
                among: Among::All,
            };
            let slower = Expectation {
                says: "its trees trace no faster",
                figure: Figure::Trace,
                range: (1.0, f64::INFINITY),
                among: Among::All,
            };
            let dearer =
                Expectation { says: "its trees have no lower SAH cost", figure: Figure::Cost, ..slower };
            [(50, "phr-fast"), (500, "phr-hq")]
                .map(|(length, base)| Comparison {
                    changed: hunt(length),
                    base: changed(base, SPATIAL_OFF),
                    expected: vec![longer, dearer, slower],
                })
                .into()
        },
        figures: FIGURES,
        families: Some(|| {
            let named = |all: Vec<(String, String)>| -> Vec<(String, String)> {
                all.into_iter().map(|(label, name)| (name, label)).collect()
            };
            Families {
                base: changed("phr-fast", SPATIAL_OFF),
                lines: vec![
                    ("adaptive threshold, by alpha, delta".into(), named(adaptive())),
                    ("constant length, by nodes".into(), named(constant())),
                    (
                        "with spatial splits".into(),
                        bases().into_iter().map(|name| (name.clone(), name)).collect(),
                    ),
                ],
            }
        }),
        more: None,
    },
    Experiment {
        name: "presplitting",
        section: "5.3",
        about: "Needles presplit, relative to whole triangles",
        paper: "spatial splits of nodes could be combined with presplitting of triangles, which was not evaluated",
        caveat: "",
        entrants: || with_bases(presplit().into_iter().chain(spatial_off()).collect()),
        comparisons: || compared(presplit(), &[]),
        figures: FIGURES,
        families: None,
        more: None,
    },
    Experiment {
        name: "bucket-sort",
        section: "4.7",
        about: "The auxiliary tree sorted by 12 bits as in the paper, relative to 32 bits",
        paper: "codes are sorted into buckets of their highest 12 bits; what the other bits would gain is not told",
        caveat: "",
        entrants: || with_bases(bucket_sort()),
        comparisons: || compared(bucket_sort(), &[]),
        figures: FIGURES,
        families: None,
        more: None,
    },
    Experiment {
        name: "auxiliary-trees",
        section: "5.5",
        about: "PHR over other auxiliary trees, relative to the same over an LBVH",
        paper: "auxiliary trees by AAC give costs that are a few percent lower at the same parameters; AAC and binned SAH are \
                both worse in the sense of Pareto, as other parameters over an LBVH give as much in less time",
        caveat: "",
        entrants: || with_bases(auxiliary_trees()),
        comparisons: || {
            let cheaper = Expectation {
                says: "the tree costs a few percent less",
                figure: Figure::Cost,
                range: (0.9, 1.0),
                among: Among::All,
            };
            let longer = Expectation {
                says: "the build takes longer",
                figure: Figure::Build,
                range: (1.0, f64::INFINITY),
                among: Among::All,
            };
            let mut all = compared(auxiliary_trees(), &[cheaper, longer]);
            for Comparison { changed, expected, .. } in &mut all {
                // Of costs the paper speaks with AAC alone, and it did not try PLOC.
                expected.retain(|it| match changed.rsplit('-').next() {
                    Some("aac") => true,
                    Some("sah") => it.figure == Figure::Build,
                    _ => false,
                });
            }
            all
        },
        figures: FIGURES,
        families: None,
        more: None,
    },
];

/// The experiment called `name`.
pub fn by_name(name: &str) -> Option<&'static Experiment> {
    EXPERIMENTS.iter().find(|experiment| experiment.name == name)
}

fn with_bases(variants: Vec<OfBase>) -> Vec<String> {
    bases().into_iter().chain(variants.into_iter().map(|variant| variant.changed)).collect()
}

fn compared(variants: Vec<OfBase>, expected: &[Expectation]) -> Vec<Comparison> {
    let comparison =
        |OfBase { base, changed }: OfBase| Comparison { changed, base, expected: expected.into() };
    variants.into_iter().map(comparison).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench::chosen::Chosen;
    use std::path::Path;

    /// What is compared or drawn takes part, and every variant can be built.
    #[test]
    fn every_comparison_is_between_entrants() {
        for experiment in EXPERIMENTS {
            let entrants = (experiment.entrants)();
            let takes_part = |name: &String| entrants.contains(name);
            for Comparison { changed, base, .. } in (experiment.comparisons)() {
                assert!(takes_part(&changed) && takes_part(&base), "{}: {changed}, {base}", experiment.name);
            }
            if let Some(families) = experiment.families.map(|families| families()) {
                assert!(takes_part(&families.base), "{}", experiment.name);
                for (name, _) in families.lines.iter().flat_map(|(_, line)| line) {
                    assert!(takes_part(name), "{}: {name}", experiment.name);
                }
            }
            // A builder that stands twice is refused, one that has another name than it is called by is not found.
            let none: [&Path; 0] = [];
            let cells = Chosen::new(&entrants, &[], &none).unwrap().single_cells(Some(4)).unwrap();
            let mut cells: Vec<String> = cells.into_iter().map(|cell| cell.builder).collect();
            let mut entrants = entrants;
            cells.sort();
            entrants.sort();
            assert_eq!(cells, entrants, "{}", experiment.name);
        }
        assert!(by_name("grid").is_some() && by_name("nothing").is_none());
    }
}
