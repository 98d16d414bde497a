//! The procedures of surgery run to their ends.

use koiter::bezier::procedures::{head, vessel};

#[test]
fn a_patch_widens_the_vessel_it_is_sewn_into() {
    let mut stages = 0;
    let account = vessel(&mut |stage| {
        assert!(
            stage
                .shell
                .0
                .iter()
                .all(|x| x.iter().all(|c| c.is_finite()))
        );
        stages += 1;
    })
    .unwrap();
    // Cut elements are divided, and the patch has elements of its own.
    assert!(account.elements > 1536 + 100, "{account:?}");
    assert!(stages > 100);
    // The patch adds up to 14 mm to a girth of 63 mm.
    assert!((1.1..1.25).contains(&account.widening), "{account:?}");
}

#[test]
fn a_head_passes_a_neck_that_is_narrower_and_leaves_it() {
    let mut last = String::new();
    let account = head(&mut |stage| last.clone_from(&stage.caption)).unwrap();
    assert_eq!(account.unconverged, 0, "{account:?}");
    // The head and half the thickness of the bag, over the neck: (45 + 3) / 38.
    assert!((1.2..1.45).contains(&account.widening), "{account:?}");
    assert!(account.most_contacts > 10, "{account:?}");
    assert_eq!(last, "0 vertices in contact");
}
