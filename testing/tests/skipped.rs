//! The last target of the workspace: how many tests went without what they need.

fn main() {
    let skipped = railspring_testing::skipped();
    for line in &skipped {
        println!("{line}");
    }
    println!("{} skipped", skipped.len());
}
