//! Options of `fabricate` that are keys of a job's `[fabrication]` too: they go through the same reader, so that they mean
//! the same and have the same limits.

use clap::Args;

/// How the sheet is cut; see docs/laser.md.
#[derive(Debug, Args)]
pub struct CutKeys {
    /// Width of the groove, millimetres [default: the profile's].
    #[arg(long, value_name = "MM")]
    kerf_mm: Option<f64>,
    /// Size of the stock [default: the profile's].
    #[arg(long, num_args = 2, value_names = ["WIDTH", "HEIGHT"])]
    sheet_mm: Option<Vec<f64>>,
    /// "r2000" or "r12".
    #[arg(long, value_name = "VERSION")]
    dxf: Option<String>,
    /// Parts on one sheet.
    #[arg(long, value_name = "N")]
    copies: Option<i64>,
    /// Between the burned edges of two parts.
    #[arg(long, value_name = "MM")]
    spacing_mm: Option<f64>,
    /// How often the beam follows each cut.
    #[arg(long, value_name = "N")]
    passes: Option<i64>,
    /// "slit-end", "mid-slit" or "scrap".
    #[arg(long, value_name = "WHERE")]
    pierce: Option<String>,
    /// "travel" or "heat".
    #[arg(long, value_name = "WHAT")]
    order: Option<String>,
    /// How long a hinge rests, of order "heat".
    #[arg(long, value_name = "S")]
    cool_s: Option<f64>,
    /// How near a cut comes that heats a hinge, of order "heat".
    #[arg(long, value_name = "MM")]
    cool_mm: Option<f64>,
    /// "none", "line" or "arc".
    #[arg(long, value_name = "SHAPE")]
    leads: Option<String>,
    /// Length of leads.
    #[arg(long, value_name = "MM")]
    lead_mm: Option<f64>,
    /// Tabs that hold each part.
    #[arg(long, value_name = "N")]
    tabs: Option<i64>,
    /// Width of a tab.
    #[arg(long, value_name = "MM")]
    tab_mm: Option<f64>,
    /// Engrave the part's name and the pieces' numbers.
    #[arg(long)]
    engrave: bool,
}

impl CutKeys {
    /// The options that were given, as a TOML table.
    pub fn table(&self) -> String {
        let number =
            |key: &'static str, value: Option<f64>| value.map(|value| (key, toml::Value::Float(value)));
        let count =
            |key: &'static str, value: Option<i64>| value.map(|value| (key, toml::Value::Integer(value)));
        let word = |key: &'static str, value: &Option<String>| {
            value.clone().map(|value| (key, toml::Value::String(value)))
        };
        let sheet = self.sheet_mm.as_ref().map(|sides| {
            ("sheet_mm", toml::Value::Array(sides.iter().copied().map(toml::Value::Float).collect()))
        });
        let given = [
            number("kerf_mm", self.kerf_mm),
            sheet,
            word("dxf", &self.dxf),
            count("copies", self.copies),
            number("spacing_mm", self.spacing_mm),
            count("passes", self.passes),
            word("pierce", &self.pierce),
            word("order", &self.order),
            number("cool_s", self.cool_s),
            number("cool_mm", self.cool_mm),
            word("leads", &self.leads),
            number("lead_mm", self.lead_mm),
            count("tabs", self.tabs),
            number("tab_mm", self.tab_mm),
            self.engrave.then_some(("engrave", toml::Value::Boolean(true))),
        ];
        given.into_iter().flatten().map(|(key, value)| format!("{key} = {value}\n")).collect()
    }
}
