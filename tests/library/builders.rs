//! Builders as values of a program: shared, kept and printed.

use phr::builders::{
    Aac, AacConfig, BoxBuilder, Builder, ClusteredPhr, ClusteredPhrConfig, Hunt, HuntConfig, Lbvh, MergedPhr,
    OptimisedPhr, OptimisedPhrConfig, Phr, PhrConfig, Ploc, PlocConfig, by_name,
};
use std::fmt::Debug;

#[test]
fn builders_are_shared_among_threads() {
    const fn shared<T: Send + Sync + 'static>() {}
    const {
        shared::<Box<dyn Builder<4>>>();
        shared::<Box<dyn Builder<8>>>();
        shared::<Box<BoxBuilder<8>>>();
        shared::<MergedPhr<8>>();
    }
}

#[test]
fn builders_print_their_name_and_configuration_alone() {
    let hunt = HuntConfig { cut_length: 50, max_leaf: 8 };
    let mesh = phr::scene::scalable(2000, 1).mesh;
    let mut used = Phr::<8>::new("phr-fast", PhrConfig::FAST).unwrap();
    used.build(&mesh);
    let printed: [(&dyn Debug, &[&str]); 9] = [
        (&used, &["Phr", "phr-fast", "max_leaf"]),
        (&Hunt::<4>::new("hunt-50", hunt).unwrap(), &["Hunt", "hunt-50", "cut_length: 50"]),
        (&Aac::<4>::new(AacConfig::FAST).unwrap(), &["Aac", "AacConfig"]),
        (&Ploc::<4>::new(PlocConfig::DEFAULT).unwrap(), &["Ploc", "radius"]),
        (&Lbvh::<4>::default(), &["Lbvh"]),
        (&MergedPhr::<4>::new(PhrConfig::HQ).unwrap(), &["MergedPhr", "max_leaf"]),
        (
            &ClusteredPhr::<4>::new("phr-turbo", ClusteredPhrConfig::TURBO).unwrap(),
            &["ClusteredPhr", "phr-turbo", "ClusteredPhrConfig"],
        ),
        (
            &OptimisedPhr::<4>::new("phr-best", OptimisedPhrConfig::DEFAULT).unwrap(),
            &["OptimisedPhr", "phr-best", "OptimisedPhrConfig"],
        ),
        (&by_name::<8>("phr-hq").unwrap(), &["Builder(\"phr-hq\")"]),
    ];
    for (builder, words) in printed {
        let text = format!("{builder:?}");
        assert!(words.iter().all(|word| text.contains(word)) && text.len() < 2000, "{text}");
    }
}
