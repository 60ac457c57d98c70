//! How the sheet is cut.

use super::*;

#[test]
fn leads_and_tabs_that_cannot_be() {
    let folder = Folder::new("leads");
    let scrap = |leads: &str| with("leads", leads);
    let cut = |text: &str| folder.read(text).unwrap().fabrication.cut;
    // To pierce in scrap is to have leads, straight ones unless asked otherwise.
    let leads = cut(&scrap("")).leads;
    assert_eq!(leads, Some(Leads { shape: LeadShape::Line, length: 1.5 }));
    let found = folder.diagnostic(&scrap("leads = \"arc\""));
    assert!(found.help.contains("an ARC of an R12 file has no direction"), "{found}");
    let arc = cut(&scrap("leads = \"arc\"").replace("dxf = \"r12\"", "")).leads;
    assert_eq!(arc.unwrap().shape, LeadShape::Arc);
    let without = scrap("").replace("pierce = \"scrap\"", "");
    assert_eq!(cut(&without.replace("lead_mm = 1.5", "")).leads, None);
    // Keys that would do nothing are told.
    for (text, key) in [
        (without, "lead_mm"),
        (with("tabs", ""), "tab_mm"),
        (with("order", ""), "cool_s"),
        (with("order", "").replace("cool_s = 7.5", ""), "cool_mm"),
    ] {
        let found = folder.diagnostic(&text);
        assert!(found.message.contains("without effect here") && found.key.contains(key), "{found}");
    }
    let mid_slit = with("pierce", "pierce = \"mid-slit\"");
    let found = folder.diagnostic(&mid_slit);
    assert!(found.message.contains("not possible with dxf = \"r12\""), "{found}");
    let mid_slit = cut(&mid_slit.replace("dxf = \"r12\"", ""));
    assert!(mid_slit.pierce == Pierce::MidSlit && mid_slit.leads.is_some());
    let found = folder.diagnostic(&scrap("leads = \"none\""));
    assert!(found.message.contains("not possible with pierce = \"scrap\""), "{found}");
    // 0.35 mm is the least web of the profile.
    let found = folder.diagnostic(&with("tab_mm", "tab_mm = 0.3"));
    assert!(found.message.contains("at least the profile's min_web_mm = 0.35"), "{found}");
    assert_eq!(cut(&with("tab_mm", "")).tabs, Some(TabWish { count: 3, width: 0.35 }));
    assert_eq!(cut(&with("tabs", "").replace("tab_mm = 0.6", "")).tabs, None);
    assert!(folder.diagnostic(&with("tabs", "tabs = 0")).message.contains("1 to 1000"));
    assert!(folder.diagnostic(&with("lead_mm", "lead_mm = 99.0")).message.contains("0.1 to 50 mm"));
}

#[test]
fn options_of_the_command_line_mean_what_the_keys_mean() {
    let mut profile = crate::profile::load("steel-304-0.5mm", Path::new("")).unwrap();
    let folder = Folder::new("options");
    let job = folder.read(JOB).unwrap().fabrication;
    let table = JOB.split("profile = \"steel-304-0.5mm\"\n").nth(1).unwrap();
    let table = table.split("\n[").next().unwrap();
    let (dxf, cut) = cut_keys(table, &mut profile).unwrap();
    assert_eq!((&profile, dxf), (&job.profile, job.dxf));
    // The part's name is the caller's.
    assert_eq!(CutOptions { engrave: job.cut.engrave.clone(), ..cut }, job.cut);
    let error = cut_keys("passes = 0\n", &mut profile).unwrap_err().to_string();
    assert!(error.contains("the options of the command line") && error.contains("passes = 0"), "{error}");
}
