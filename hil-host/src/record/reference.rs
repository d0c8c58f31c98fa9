//! The reference of the record's columns, as it is written next to every record.

use super::row::Row;
use std::fmt::Write as _;

/// The text of `record-columns.md`.
pub(crate) fn column_reference() -> String {
    let mut text = format!(
        "# Columns of record.npy\n\n\
         One row of {} bytes per control cycle, little-endian, without gaps, in the order of this \
         table.\n`numpy.load(\"record.npy\")` gives them by name. An array has one entry per \
         damper slot, in the order\nof the scenario, unless its meaning states another order. \
         Every further hour of a long run has a\nfile of its own with the same columns: \
         `record.part02.npy`, `record.part03.npy` and so on.\n\n\
         | column | type | shape | unit | meaning |\n| --- | --- | --- | --- | --- |\n",
        Row::size()
    );
    for ((name, kind, shape), meaning) in Row::fields().into_iter().zip(Row::meanings()) {
        let shape: Vec<String> = shape.iter().map(usize::to_string).collect();
        let shape = if shape.is_empty() { "-".to_owned() } else { shape.join(" x ") };
        // A bar begins the next column of the table.
        let (kind, unit) = (kind.replace('|', ""), unit(name));
        // Writing to a string cannot fail.
        let _ = writeln!(text, "| `{name}` | `{kind}` | {shape} | {unit} | {meaning} |");
    }
    text.push_str(
        "\nCodes of `force_source`: 0 nothing is mounted, 1 the model of a slot without a rig, 2 a \
         rig,\n3 the rig of another slot, 4 the model of a slot whose rig has dropped out; `coupling` \
         fades between\nthem.\n\n\
         Codes of `input`: 0 no rig, 1 a new measurement with a valid force, 2 nothing arrived, \
         3 a frame\nthat failed a check or a force that the rig reports as invalid. Codes of \
         `drift`: 0 no watch,\n1 learning, 2 steady, 3 drift.\n\n\
         Codes of `state` and `rig_state`: 0 INIT, 1 STANDBY, 2 ARMED, 3 RAMP_IN, 4 RUN, 5 \
         RAMP_OUT, 6 SAFE,\n7 FAULT. Bits of `rig_flags`: 1 saturated, 2 limit reached, 4 \
         sensor invalid, 8 actuator lagging.\n",
    );
    text
}

/// The unit that a column's name ends in.
fn unit(name: &str) -> &'static str {
    const UNITS: [(&str, &str); 9] = [
        ("rad_per_s2", "rad/s2"),
        ("_degc", "degC"),
        ("_cycles", "cycles"),
        ("_m_per_s2", "m/s2"),
        ("_m_per_s", "m/s"),
        ("_ns", "ns"),
        ("_s", "s"),
        ("_m", "m"),
        ("_n", "N"),
    ];
    UNITS.iter().find(|(end, _)| name.ends_with(end)).map_or("-", |(_, unit)| unit)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::record::{ForceSource, InputKind};
    use can_protocol::Watch;

    #[test]
    fn the_page_in_the_docs_is_the_reference_next_to_a_record() {
        let page = concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/record-columns.md");
        assert_eq!(std::fs::read_to_string(page).unwrap(), column_reference());
    }

    #[test]
    fn every_column_has_its_unit_and_the_codes_are_those_of_the_record() {
        let text = column_reference();
        for line in [
            "| `cycle` | `<u8` | - | - | Number of the cycle, from one. |",
            "| `frame` | `u1` | 4 x 16 | - | Payload of the frame that the input came from. |",
            "| `force_n` | `<f8` | 4 | N | Force of every slot as the vehicle felt it in the last \
             substep (N). |",
        ] {
            assert!(text.contains(line), "{line}\n{text}");
        }
        for (name, unit) in [("lateness_ns", "ns"), ("time_s", "s"), ("hash", "-")] {
            assert_eq!(super::unit(name), unit, "{name}");
        }
        assert_eq!(InputKind::ALL.map(InputKind::code), [0, 1, 2, 3]);
        assert_eq!(ForceSource::ALL.map(ForceSource::code), [0, 1, 2, 3, 4]);
        let watch = [Watch::None, Watch::Learning, Watch::Steady, Watch::Drift];
        assert_eq!(watch.map(Watch::code), [0, 1, 2, 3]);
    }
}
