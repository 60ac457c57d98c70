//! Guides.

use super::*;

#[test]
fn guides_are_read_and_those_that_contradict_themselves_are_refused() {
    let folder = Folder::new("guides");
    let free = JOB.replace("open = \"roof.obj\"", "open = \"free\"");
    let free = free.replace("closed = \"flat\"", "closed = \"roof.obj\"");
    let read = |guide: &str| folder.read(&format!("{free}\n[[guide]]\n{guide}"));
    let way = |guide: &str| read(guide).unwrap().guides[0].way.clone();
    let (place, end) = (Point3::new(1.0, 2.0, -3.5), Point3::new(0.0, 0.5, 9.0));
    let point = GuideWay::Point { closed: place, open: end };
    assert_eq!(way("closed = [1.0, 2.0, -3.5]\nopen = [0.0, 0.5, 9.0]\nweight = 2.0"), point);
    assert_eq!(
        way("closed = [1.0, 2.0, -3.5]\nfixed = true"),
        GuideWay::Point { closed: place, open: place }
    );
    let file = folder.0.join("roof.obj");
    let curve = GuideWay::Curve { closed: file.clone(), open: file };
    assert_eq!(way("closed_curve = \"roof.obj\"\nfixed = true"), curve);
    assert_eq!(way("closed_curve = \"roof.obj\"\nopen_curve = \"roof.obj\""), curve);
    assert_eq!(read("closed = [1, 2, 3]\nfixed = true").unwrap().guides[0].weight, 1.0);
    for (guide, says) in [
        ("closed = [1, 2, 3]\nopen = [1, 2, 3]\nfixed = true", "do not go together"),
        ("closed = [1, 2, 3]\nopen_curve = \"roof.obj\"", "do not go together"),
        ("closed = [1, 2, 3]\nclosed_curve = \"roof.obj\"\nfixed = true", "both closed and closed_curve"),
        ("closed = [1, 2, 3]\nfixed = true\nweight = 1001.0", "guide.weight = 1001.0 is out of range"),
        ("closed = [1, 2, nan]\nfixed = true", "not a finite number"),
        ("place = [1, 2, 3]", "unknown key"),
    ] {
        match read(guide) {
            Err(JobError::Job(TomlError::Invalid(found))) if found.message.contains(says) => {}
            other => panic!("{guide}: {other:?}"),
        }
    }
}
