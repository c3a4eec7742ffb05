//! The unit of a column of times: said by who reads it, by the file, or by the column's name.

use super::{DataError, Table};
use crate::unit::{Unit, UserUnit};

/// The unit of the times in `column`: that of the file, or of the column's name (`t_ms`), where the
/// one that is `given` is not said but assumed; else the one given.
///
/// # Errors
/// A unit of something else, one that is not known where nothing else says it, and one that is said
/// otherwise: times that are wrong by a factor show as anything but that.
pub fn unit_of_times(
    table: &Table,
    column: &str,
    given: &UserUnit,
    is_said: bool,
) -> Result<UserUnit, DataError> {
    let found = said_unit(table, column, given, is_said).map_err(|message| DataError::Channel {
        source_name: table.source.clone(),
        column: column.to_owned(),
        channel: "the times".to_owned(),
        message,
    })?;
    Ok(found.unwrap_or_else(|| given.clone()))
}

/// The unit that the file gives its times in `column`; `None` where it gives none. A column without
/// a dimension is one of numbers that say nothing of it.
fn said_unit(
    table: &Table,
    column: &str,
    given: &UserUnit,
    is_said: bool,
) -> Result<Option<UserUnit>, String> {
    let by_name = || {
        let symbol = named_unit(column).filter(|_| !is_said)?;
        UserUnit::parse(symbol).ok()
    };
    let Some(written) = table.units.get(column) else {
        return Ok(by_name());
    };
    let times = || {
        let symbols: Vec<&str> = Unit::Second.accepted_symbols().collect();
        symbols.join(", ")
    };
    let found = match UserUnit::parse(written) {
        Ok(found) => found,
        Err(_) if is_said => return Ok(None),
        Err(_) => {
            return Err(format!(
                "the file gives its unit as \"{written}\", which is not known; give `time_unit`, one of {}",
                times()
            ));
        }
    };
    if found.unit == Unit::One {
        return Ok(by_name());
    }
    if found.unit != Unit::Second {
        return Err(format!(
            "the file gives its unit as \"{}\", but times have one of {}; name the column of the times",
            found.symbol,
            times()
        ));
    }
    if is_said && found.si_factor != given.si_factor {
        return Err(format!(
            "the file gives its unit as \"{}\", but `time_unit` is \"{}\"; leave that out, or mend the unit in \
             the file",
            found.symbol, given.symbol
        ));
    }
    Ok(Some(found))
}

/// The unit of time that a column's name ends in: `t_ms`.
pub(super) fn named_unit(name: &str) -> Option<&'static str> {
    let name = name.to_lowercase();
    let mut units = ["ns", "us", "ms", "s"].into_iter();
    units.find(|unit| name.ends_with(&format!("_{unit}")))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measured::{ChannelMapping, Column, Mapping, Measured, Role, TimeBase, measured};

    fn mapping(time: TimeBase, is_time_unit_said: bool) -> Mapping {
        Mapping {
            time,
            is_time_unit_said,
            clock_rate: 1.0,
            window_s: [f64::NEG_INFINITY, f64::INFINITY],
            resample_hz: None,
            max_gap_s: 0.05,
            starts_s: Vec::new(),
            bridge_spikes: true,
            channels: Vec::new(),
        }
    }

    /// A sine at 100 Hz whose times the file gives in `unit`, by the times in `said` or by none.
    fn by_unit(unit: &str, said: Option<&str>) -> Result<Measured, DataError> {
        let rows = 0..300;
        let values: [Vec<f64>; 2] = [
            rows.clone().map(|k| f64::from(k) * 10.0).collect(),
            rows.map(|k| (0.1 * f64::from(k)).sin()).collect(),
        ];
        let columns = ["Zeit", "q"].into_iter().zip(values);
        let table = Table {
            source: "bench.csv".into(),
            columns: columns
                .map(|(name, values)| Column {
                    name: name.into(),
                    values,
                })
                .collect(),
            units: [("Zeit".to_owned(), unit.to_owned())].into(),
            lines: (2..302).collect(),
            ..Table::default()
        };
        let time = TimeBase::Column {
            column: "Zeit".into(),
            unit: UserUnit::parse(said.unwrap_or("s")).unwrap(),
        };
        let channel = ChannelMapping {
            terms: vec!["q".into()],
            channel: "joint1.position".into(),
            unit: UserUnit::from(Unit::Metre),
            scale: 1.0,
            offset: 0.0,
            role: Role::Output,
            noise: None,
            saturation: None,
        };
        let mapping = Mapping {
            channels: vec![channel],
            ..mapping(time, said.is_some())
        };
        measured(&table, &mapping)
    }

    #[test]
    fn the_unit_that_a_file_gives_its_times_is_taken() {
        for said in [None, Some("ms")] {
            let data = by_unit("ms", said).unwrap();
            assert!((data.rate_hz() - 100.0).abs() < 1e-6, "{said:?}");
            let noted = data
                .notes
                .iter()
                .any(|note| note == "times are in ms, as the file says of `Zeit`");
            assert_eq!(noted, said.is_none(), "{:?}", data.notes);
        }
        // Numbers that have no dimension say nothing, nor does a unit that is not known.
        for unit in ["1", "ticks"] {
            let data = by_unit(unit, Some("ms")).unwrap();
            assert!((data.rate_hz() - 100.0).abs() < 1e-6, "{unit}");
        }
    }

    #[test]
    fn a_unit_of_times_that_the_file_contradicts_is_refused() {
        let refusal = |unit: &str, said| by_unit(unit, said).unwrap_err().to_string();
        let told = refusal("ms", Some("s"));
        let both = "column \"Zeit\" (the times): the file gives its unit as \"ms\", but `time_unit` is \"s\"";
        assert!(told.contains(both), "{told}");
        let told = refusal("ticks", None);
        let unknown =
            "column \"Zeit\" (the times): the file gives its unit as \"ticks\", which is not known";
        assert!(told.contains(unknown), "{told}");
        let told = refusal("mm", None);
        assert!(
            told.contains("times have one of s, ms, us, ns, min"),
            "{told}"
        );
    }

    /// A name says the unit only where neither the file nor the scenario does.
    #[test]
    fn the_unit_at_the_end_of_a_name_is_taken() {
        let second = UserUnit::from(Unit::Second);
        let unit = |name: &str, file: Option<&str>, is_said| {
            let units = file.map(|unit| (name.to_owned(), unit.to_owned()));
            let table = Table {
                units: units.into_iter().collect(),
                ..Table::default()
            };
            unit_of_times(&table, name, &second, is_said).map(|unit| unit.symbol)
        };
        assert_eq!(unit("t_ms", None, false).as_deref(), Ok("ms"));
        assert_eq!(unit("T_us", Some("1"), false).as_deref(), Ok("us"));
        assert_eq!(unit("t_ms", Some("ns"), false).as_deref(), Ok("ns"));
        assert_eq!(unit("t_ms", None, true).as_deref(), Ok("s"));
        assert_eq!(unit("terms", None, false).as_deref(), Ok("s"));
    }
}
