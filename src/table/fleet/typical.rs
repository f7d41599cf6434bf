//! The profiles that stand for the fleet: groups of shapes and their medoids.

use std::collections::BTreeSet;

use serde_json::{Map, Value};

use super::about::About;
use super::bodies::Bodies;
use super::counts::named;
use super::medoids::Groups;
use super::robust::sorted;
use super::section::{Section, Table, deviations};
use super::shape::{Shape, Shapes};
use crate::report::number::round;
use crate::rounding::significant;
use crate::verify::quantile;

/// Numbers of groups that are tried.
const COUNTS: std::ops::RangeInclusive<usize> = 2..=8;
/// Silhouette below which there are no groups to speak of (Kaufman and Rousseeuw, 1990).
const CLEAR: f64 = 0.25;

/// Shapes without a group that are named.
const NAMED: usize = 12;

/// A profile that stands for a group.
#[derive(Debug, Clone, PartialEq)]
pub struct Typical {
    /// Its name in the rows.
    pub name: String,
    /// Bodies of the group over all with a shape.
    pub share: f64,
}

/// The section, and the profiles.
pub fn section(bodies: &Bodies<'_>, shapes: &Shapes<'_>) -> (Section, Vec<Typical>) {
    let kind = bodies.kind;
    let mut section = Section::new(
        &format!("{}-typical", kind.name()),
        &format!("Typical {} that stand for the fleet", kind.several()),
    );
    let (known, whole): (Vec<usize>, Vec<&Shape>) =
        shapes.of.iter().enumerate().filter_map(|(body, shape)| Some((body, (*shape)?))).unzip();
    if shapes.left_out > 0 {
        section.missing.push(format!(
            "The shapes of {} {} have gaps or other coordinates and are left out.",
            shapes.left_out,
            kind.several()
        ));
    }
    let Some(groups) = Groups::of(&whole, COUNTS) else {
        section.missing.push(format!(
            "The shapes of {} {} are known; groups need ten.",
            whole.len(),
            kind.several()
        ));
        return (section, Vec::new());
    };
    let size = |group: usize| groups.size(group);
    let share = |group: usize| size(group) as f64 / whole.len() as f64;
    let typical: Vec<Typical> = groups
        .medoids
        .iter()
        .enumerate()
        .map(|(group, medoid)| Typical {
            name: bodies.bodies[known[*medoid]].name.clone(),
            share: share(group),
        })
        .collect();
    let alone = groups.group.iter().filter(|group| group.is_none()).count();
    section.text.push(format!(
        "{} shapes fall into {} groups. Each is around the measured profile to which the others of the group are nearest. Distance is the root mean square of the difference of the deviations. The mean silhouette of {:.2} chose the number of groups: 1 is far apart, 0 is none.",
        whole.len(),
        groups.medoids.len(),
        groups.silhouette
    ));
    if groups.silhouette < CLEAR {
        section
            .text
            .push("The shapes change from one to the next without gaps; the groups only part them.".into());
    }
    if alone > 0 {
        let far = known.iter().zip(&groups.group).filter(|(_, group)| group.is_none());
        let far: BTreeSet<String> = far.map(|(body, _)| bodies.bodies[*body].name.clone()).collect();
        let names = named(&far, NAMED);
        section.text.push(format!("{alone} shapes are far from all groups and belong to none: {names}."));
    }
    let tried: Vec<String> = groups.tried.iter().map(|(count, of)| format!("{count}: {of:.2}")).collect();
    section.text.push(format!("Silhouette by the number of groups: {}.", tried.join(", ")));
    let head = [
        "group",
        "#share",
        &format!("#{}", kind.several()),
        "typical profile",
        "#distance of half of them, mm",
    ];
    let mut table = Table::new("The groups, the largest first.".into(), &head);
    for (group, of) in typical.iter().enumerate() {
        let members: Vec<usize> = (0..whole.len()).filter(|at| groups.group[*at] == Some(group)).collect();
        let medoid = whole[groups.medoids[group]];
        let distances = sorted(members.iter().map(|at| whole[*at].distance(medoid)));
        let half = quantile(&distances, 0.5).map_or_else(String::new, |half| significant(1e-3 * half, 2));
        let percent = format!("{} %", round((1e3 * of.share).round() / 10.0));
        table.rows.push(vec![
            (group + 1).to_string(),
            percent.clone(),
            size(group).to_string(),
            of.name.clone(),
            half,
        ]);
        let band = shapes.band(members.iter().map(|at| known[*at]));
        let caption =
            format!("Group {}, {percent}: {} (line) and 5 to 95 % of its group (grey).", group + 1, of.name);
        section.small.push(deviations(shapes.y_mm, &band, &medoid.off_um, caption));
    }
    section.table(table);
    (section, typical)
}

/// `table_typical.toml`: a table whose wheels are these profiles. None where the keys of one are not known.
pub fn table(about: &About<'_>, typical: &[Typical]) -> Option<String> {
    let mut text = format!(
        "# Measured wheels that stand for those of the table {}, with the shares of their groups.\n\
         # A vehicle program reads their profiles; `railspring table` makes their springs.\n\
         name = {}\n{}",
        toml::Value::from(about.name),
        toml::Value::from(format!("{}-typical", about.name)),
        toml::to_string(&keys(&about.table)).ok()?
    );
    for of in typical {
        let mut keys = keys(about.keys.get(&of.name)?);
        keys.insert("name".into(), of.name.as_str().into());
        let percent = round((1e3 * of.share).round() / 10.0);
        text += &format!("\n# {percent} % of the wheels\n[[wheel]]\n{}", toml::to_string(&keys).ok()?);
    }
    Some(text)
}

/// Keys as TOML has them; it has none without a value.
fn keys(keys: &Map<String, Value>) -> toml::Table {
    let of = |(key, value): (&String, &Value)| Some((key.clone(), toml::Value::try_from(value).ok()?));
    keys.iter().filter_map(of).collect()
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;

    /// Goal: the file is TOML with a wheel for each profile and its keys, below the other keys of the table; without the keys of one there is no file.
    #[test]
    fn typical_wheels_are_a_table() {
        let typical = |name: &str, share| Typical { name: name.into(), share };
        let wheel = |file: &str| Map::from_iter([("profile_file".to_string(), Value::from(file))]);
        let rest = serde_json::json!({ "base": null, "rail": [{ "profile": "60E1" }], "shifts_mm": [0.0, 2.5], "study": { "mesh": { "size": 1 } } });
        let about = About {
            name: "fleet",
            keys: BTreeMap::from([("a \"1\"".to_string(), wheel("m/a.whl")), ("b".into(), wheel("m/b.whl"))]),
            table: rest.as_object().unwrap().clone(),
            ..About::default()
        };
        let text = table(&about, &[typical("a \"1\"", 0.6123), typical("b", 0.3)]).unwrap();
        let read: toml::Table = text.parse().unwrap();
        assert_eq!(read["name"].as_str(), Some("fleet-typical"));
        assert_eq!(read["shifts_mm"][1].as_float(), Some(2.5));
        assert_eq!(read["rail"][0]["profile"].as_str(), Some("60E1"));
        assert_eq!(read["wheel"][0]["name"].as_str(), Some("a \"1\""));
        assert_eq!(read["wheel"][1]["profile_file"].as_str(), Some("m/b.whl"));
        assert!(text.contains("# 61.2 % of the wheels"), "{text}");
        assert_eq!(table(&about, &[typical("c", 1.0)]), None);
    }
}
