//! Writes the measured pairs of the tests into a folder: `measured_pairs FOLDER COUNT`.

use railspring_testing::shapes::measured_pair;

fn main() -> std::io::Result<()> {
    let mut given = std::env::args().skip(1);
    let folder = std::path::PathBuf::from(given.next().unwrap_or_else(|| "measured".into()));
    let count = given.next().and_then(|count| count.parse().ok()).unwrap_or(40);
    std::fs::create_dir_all(&folder)?;
    for seed in 0..count {
        let pair = measured_pair(seed);
        for (name, text, _) in [&pair.wheel, &pair.rail] {
            std::fs::write(folder.join(name), text)?;
        }
        println!("{} {} {}", pair.wheel.0, pair.rail.0, pair.name);
    }
    Ok(())
}
