use super::*;

#[test]
fn nothing_of_a_job_ends_the_data_or_begins_markup() {
    let json = serde_json::to_string("</script><script>alert(1)</script><!--").unwrap();
    let escaped = for_script(&json);
    assert!(!escaped.contains('<'), "{escaped}");
    assert_eq!(
        serde_json::from_str::<Value>(&escaped).unwrap(),
        serde_json::from_str::<Value>(&json).unwrap()
    );
    assert_eq!(for_html("a<b> & \u{7}c"), "a&lt;b&gt; &amp;  c");
}

#[test]
fn the_page_asks_for_nothing_outside_of_itself() {
    for part in SCRIPT.iter().chain([&STYLE, &PAGE]) {
        for word in ["src=", "@import", "url(", "fetch(", "XMLHttpRequest", "innerHTML", "https://"] {
            assert!(!part.contains(word), "{word}");
        }
    }
    // Every place is filled, and only these are there.
    let places: Vec<&str> = PAGE.split("{{").skip(1).map(|rest| rest.split("}}").next().unwrap()).collect();
    assert_eq!(places, ["title", "style", "data", "three", "script"]);
    // A page in a page: nothing in the bundle ends its script or begins a comment of HTML, and nothing in it loads.
    for word in ["</script", "<!--", "fetch(", "XMLHttpRequest", "import(", "importScripts", "eval(", "{{"] {
        assert!(!THREE.contains(word), "{word}");
    }
    assert!(THREE.contains("SPDX-License-Identifier: MIT"), "the notice of three.js");
}
