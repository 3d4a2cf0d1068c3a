use super::*;

#[test]
fn the_standard_set_is_what_it_writes() {
    let set = ReplicaSet::standard(0.05);
    assert_eq!(
        set.to_string(),
        "uniform+16;1,0,1,1,1,1;1,0,0,1,1,1;1,0,0,0,0,0.05*3~8"
    );
    assert_eq!(set.to_string().parse(), Ok(set));
    assert!(set.is_specific() && set.is_line() && set.count() == 4);
    assert_eq!((set.repeats(), set.tour()), (&[1, 1, 1, 3][..], TOUR));
    assert_eq!("paper".parse(), Ok(ReplicaSet::paper(ReplicaSet::DELTA)));
    let paper = ReplicaSet::paper(0.05);
    assert_eq!((paper.repeats(), paper.tour()), (&[1; 4][..], 0));
    assert_eq!(set.pairs(4), [(0, 1), (1, 2), (2, 3)]);
    assert_eq!(set.pairs(3), [(0, 1), (1, 2)]);
}

#[test]
fn the_specific_replica_leaves_out_what_others_find() {
    let joined = |set: &ReplicaSet| -> Vec<f64> {
        let weights = (0..set.count()).map(|k| set.weights(k));
        weights.map(|w| w[Class::L0Joined as usize]).collect()
    };
    assert_eq!(joined(&ReplicaSet::paper(0.05)), [0.0, 1.0, 1.0, 0.0]);
    assert_eq!(joined(&ReplicaSet::sides()), [0.0, 1.0, 0.0]);
    // what is easy to find is nobody's, the rest of implicit specular light whose it was
    let left = ReplicaSet::paper(0.05).leaving_specular();
    assert_eq!(joined(&left), [0.0, 1.0, 1.0, 0.0]);
    assert!((0..4).all(|k| left.weights(k)[Class::L0 as usize].to_bits() == 0));
    assert_eq!(left.weights(3)[1..WEIGHED], left.rows()[3][1..]);
    // the last is not specific
    let even: ReplicaSet = "uniform;1,1,1,1,1,1;0.5,0,0,0,0,0.5".parse().unwrap();
    assert_eq!(joined(&even), [0.0, 1.0, 0.5]);
    assert_eq!(even.weights(2)[..WEIGHED], even.rows()[2]);
}

#[test]
fn sides_stand_side_by_side() {
    let sides: ReplicaSet = "sides".parse().unwrap();
    assert_eq!(
        sides.to_string(),
        "uniform;1,1,1,0,0,1;0,0,0,1,1,1@1",
        "neither is nested in the other"
    );
    assert_eq!(sides.to_string().parse(), Ok(sides));
    assert_eq!((sides.below(), sides.is_line()), (&[0, 0, 0][..], false));
    assert_eq!(sides.pairs(3), [(0, 1), (0, 2), (1, 2)]);
    assert!(!sides.is_specific());
    let tree: ReplicaSet = "uniform*2+5;1,1,1,1,1,1;1,0,0,0,0,0;0,0,0,0,1,0*4@2"
        .parse()
        .unwrap();
    assert_eq!(tree.below(), [0, 0, 1, 1]);
    assert_eq!((tree.repeats(), tree.scouts()), (&[2, 1, 1, 4][..], 5));
    assert_eq!(tree.pairs(4), [(0, 1), (1, 2), (1, 3), (2, 3)]);
    assert_eq!(tree.to_string().parse(), Ok(tree));
}

#[test]
fn what_is_no_set_is_refused_with_the_place() {
    use ReplicaSetError as E;
    let refused = |text: &str| text.parse::<ReplicaSet>().unwrap_err();
    assert_eq!(refused("1,0,1,1,1,1"), E::NotUniform("1,0,1,1,1,1".into()));
    assert_eq!(refused("uniform"), E::Count(1));
    let many = format!("uniform{}", ";1,1,1,1,1,1".repeat(11));
    assert_eq!(refused(&many), E::Count(12));
    for row in [
        "",
        "1,2,3",
        "0,0,0,0,0,0",
        "1,0,-1,0,0,0",
        "1,0,nan,0,0,0",
        "1,0,1e31,0,0,0",
        "1,0,1e-31,0,0,0",
        "a,0,0,0,0,1",
    ] {
        let (replica, found) = (3, row.to_owned());
        let text = format!("uniform;1,1,1,1,1,1;{row}");
        assert_eq!(refused(&text), E::Row { replica, found });
    }
    for on in ["", "@2"] {
        let (replica, class, below) = (3, Class::L1, 2);
        let error = refused(&format!("uniform;1,0,0,0,0,0;1,1,0,0,0,0{on}"));
        assert_eq!(
            error,
            E::Nesting {
                replica,
                class,
                below
            }
        );
    }
    for found in ["2", "0", "x"] {
        let error = refused(&format!("uniform;1,0,0,0,0,0@{found}"));
        let (replica, found) = (2, found.to_owned());
        assert_eq!(error, E::Below { replica, found });
    }
    assert_eq!(
        refused("uniform+1025;1,0,0,0,0,0"),
        E::Scouts("1025".into())
    );
    for repeats in ["0", "65", "x", ""] {
        let error = refused(&format!("uniform;1,0,0,0,0,0*{repeats}"));
        assert_eq!(error, E::Repeats(repeats.into()));
    }
    for tour in ["0", "1025", "x", "", "8*3"] {
        let error = refused(&format!("uniform;1,0,0,0,0,0;1,0,0,0,0,0*2~{tour}"));
        assert_eq!(error, E::Tour(tour.into()));
    }
    // of one that is not the last, with one step, of one that is not specific, of the uniform one
    for (set, error) in [
        ("uniform;1,0,0,0,0,0*2~8;1,0,0,0,0,0", E::Tours),
        ("uniform;1,0,0,0,0,0;1,0,0,0,0,0~8", E::Tours),
        ("uniform;1,0,0,0,0,1;1,0,0,0,0,1*2~8", E::Tours),
        ("uniform;1,0,0,0,0,0*2~8", E::Tours),
        ("uniform*2~8;1,0,0,0,0,0", E::Repeats("2~8".into())),
    ] {
        assert_eq!(refused(set), error, "{set}");
    }
    assert_eq!(
        refused("uniform;1,0,0,0,0,0;1,1,0,0,0,0").to_string(),
        "replica 3 weighs class L1, and replica 2, on which it stands, does not"
    );
    let plain: ReplicaSet = "uniform; 1,0,1,1,1,1".parse().unwrap();
    assert!(!plain.is_specific() && plain.count() == 2);
}
