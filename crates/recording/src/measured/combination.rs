//! Linear combinations of columns: what couples joints or turns currents into torques.

use super::{ChannelMapping, DataError, Table};
use crate::unit::significant;

/// One column in a sum.
#[derive(Clone, Debug, PartialEq)]
pub struct Term {
    /// Name of the column, or its number counted from 1 in a file without header.
    pub column: String,
    /// Factor on its values; not 0.
    pub factor: f64,
}

impl From<&str> for Term {
    /// The column as it is.
    fn from(column: &str) -> Term {
        Term {
            column: column.to_owned(),
            factor: 1.0,
        }
    }
}

/// How the sum is written: the name of a column that stands alone, else `2 × a − 0.5 × b`.
pub fn formula(terms: &[Term]) -> String {
    if let [Term { column, factor }] = terms
        && *factor == 1.0
    {
        return column.clone();
    }
    let mut text = String::new();
    for (index, term) in terms.iter().enumerate() {
        text.push_str(match (index, term.factor < 0.0) {
            (0, false) => "",
            (0, true) => "−",
            (_, false) => " + ",
            (_, true) => " − ",
        });
        let size = significant(term.factor.abs(), 6);
        text.push_str(&format!("{size} × {}", term.column));
    }
    text
}

impl ChannelMapping {
    /// How messages call what is read: the column, or the sum.
    pub fn source(&self) -> String {
        formula(&self.terms)
    }

    /// Whether it is more than one column with a factor.
    pub(super) fn is_combined(&self) -> bool {
        self.offset != 0.0 || !matches!(&self.terms[..], [one] if one.factor == 1.0)
    }

    /// What makes the channel of the columns, in its unit.
    pub(super) fn whole_formula(&self) -> String {
        let sum = self.source();
        let scaled = match self.scale == 1.0 {
            true => sum,
            false => format!("{} × ({sum})", significant(self.scale, 6)),
        };
        let size = significant(self.offset.abs(), 6);
        let unit = &self.unit.symbol;
        match self.offset {
            offset if offset > 0.0 => format!("{scaled} + {size} {unit}"),
            offset if offset < 0.0 => format!("{scaled} − {size} {unit}"),
            _ => format!("{scaled}, in {unit}"),
        }
    }
}

/// The columns of a sum with their factors.
pub(super) struct Columns<'a>(Vec<(&'a [f64], f64)>);

impl<'a> Columns<'a> {
    /// # Errors
    /// A column that is not there; the nearest one is named.
    pub fn of(table: &'a Table, terms: &[Term]) -> Result<Columns<'a>, DataError> {
        let found = terms
            .iter()
            .map(|term| Ok((table.column(&term.column)?, term.factor)));
        Ok(Columns(found.collect::<Result<_, DataError>>()?))
    }

    /// The readings of a row, as in the file.
    pub fn readings(&self, row: usize) -> impl Iterator<Item = f64> + '_ {
        self.0.iter().map(move |(values, _)| values[row])
    }

    /// Their sum.
    pub fn sum(&self, row: usize) -> f64 {
        let terms = self.0.iter().map(|(values, factor)| values[row] * factor);
        terms.sum()
    }
}

impl Table {
    /// The sum of columns, row by row; no number where one of them has none.
    ///
    /// # Errors
    /// A column that is not there; the nearest one is named.
    pub fn combined(&self, terms: &[Term]) -> Result<Vec<f64>, DataError> {
        let columns = Columns::of(self, terms)?;
        Ok((0..self.rows()).map(|row| columns.sum(row)).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measured::{
        Column, Mapping, Measured, Role, Tables, TimeBase, measured, measured_of,
    };
    use crate::unit::UserUnit;

    const ROWS: usize = 300;

    fn table(name: &str, columns: &[&str]) -> Table {
        let values = |shift: usize| (0..ROWS).map(move |row| ((row + 7 * shift) % 50) as f64);
        let columns = columns.iter().enumerate();
        let columns = columns.map(|(index, name)| Column {
            name: (*name).into(),
            values: values(index).collect(),
        });
        Table {
            source: name.into(),
            columns: columns.collect(),
            ..Table::default()
        }
    }

    fn mapping(terms: &[(&str, f64)]) -> Mapping {
        let term = |(column, factor): &(&str, f64)| Term {
            column: (*column).into(),
            factor: *factor,
        };
        Mapping {
            time: TimeBase::Rate { hz: 100.0 },
            is_time_unit_said: false,
            clock_rate: 1.0,
            window_s: [f64::NEG_INFINITY, f64::INFINITY],
            resample_hz: None,
            starts_s: Vec::new(),
            max_gap_s: 0.001,
            bridge_spikes: false,
            channels: vec![ChannelMapping {
                terms: terms.iter().map(term).collect(),
                channel: "joint5.drive_force".into(),
                unit: UserUnit::parse("kN").unwrap(),
                scale: 2.0,
                offset: 0.25,
                role: Role::Output,
                noise: None,
                saturation: None,
            }],
        }
    }

    fn valid(data: &Measured) -> Vec<bool> {
        data.channels[0].valid.clone()
    }

    #[test]
    fn verify_a_channel_is_the_sum_scaled_and_shifted_in_its_unit() {
        let table = table("log.csv", &["a", "b"]);
        let data = measured(&table, &mapping(&[("a", 1.5), ("b", -0.5)])).unwrap();
        for row in 0..ROWS {
            let [a, b] = [0, 1].map(|at: usize| table.columns[at].values[row]);
            let wanted = 1e3 * (2.0 * (1.5 * a - 0.5 * b) + 0.25);
            let found = data.channels[0].values[row];
            assert!((found - wanted).abs() <= 1e-9, "{row}: {found}, {wanted}");
        }
        let said = "2.00000 × (1.50000 × a − 0.500000 × b) + 0.250000 kN";
        assert!(
            data.notes.iter().any(|note| note.ends_with(said)),
            "{:?}",
            data.notes
        );
        assert!(data.channels[0].spec.description.contains(said));
    }

    #[test]
    fn a_sample_that_one_column_lacks_is_missing() {
        let mut table = table("log.csv", &["a", "b"]);
        table.columns[0].values[40] = f64::NAN;
        table.columns[1].values[90] = f64::INFINITY;
        let mut mapping = mapping(&[("a", 1.0), ("b", 3.0)]);
        let masked = |mapping: &Mapping| {
            let valid = valid(&measured(&table, mapping).unwrap());
            let rows = valid.iter().enumerate();
            rows.filter(|(_, valid)| !**valid)
                .map(|(row, _)| row)
                .collect::<Vec<_>>()
        };
        assert_eq!(masked(&mapping), [40, 90]);
        // The end of the range is each column's own: 49 in the one or in the other.
        mapping.channels[0].saturation = Some([-1.0, 49.0]);
        let at_end = |row: &usize| row % 50 == 49 || (row + 7) % 50 == 49;
        // The last row is at the end, too: the result ends with the last measurement.
        let wanted: Vec<usize> = (0..ROWS - 1)
            .filter(|row| at_end(row) || [40, 90].contains(row))
            .collect();
        assert_eq!(masked(&mapping), wanted);
    }

    #[test]
    fn columns_of_two_topics_have_no_times_in_common() {
        let tables = Tables {
            source: "run.mcap".into(),
            tables: vec![table("/arm", &["/arm/a"]), table("/hand", &["/hand/b"])],
            unread: Vec::new(),
        };
        let refused = measured_of(&tables, &mapping(&[("/arm/a", 1.0), ("/hand/b", 1.0)]));
        let told = refused.unwrap_err().to_string();
        assert!(told.contains("of /arm and of /hand"), "{told}");
        measured_of(&tables, &mapping(&[("/hand/b", 1.0)])).unwrap();
    }
}
