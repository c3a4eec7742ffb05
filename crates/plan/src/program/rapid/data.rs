//! Data of a module: tools, work objects, speeds, zones and targets.

use std::collections::BTreeMap;

use nalgebra::{Isometry3, Quaternion, Translation3, UnitQuaternion, Vector3};
use truecut_arm::ToolLoad;

use super::{Confdata, MAX_M_PER_S, NO_LOAD_KG, SPEEDS, UNUSED_AXIS, zone_radius_m};
use crate::program::source::Value;
use crate::program::{ProgramErrorKind, Zone};

/// By how much the squares of a quaternion's parts may miss 1: four decimals are enough.
const UNIT: f64 = 2e-4;

/// A tool as the module declares it.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct ToolData {
    pub flange_from_tool: Isometry3<f64>,
    pub load: ToolLoad,
}

/// A position, with its configuration.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Target {
    pub pose: Isometry3<f64>,
    pub confdata: Confdata,
    pub turntable_deg: Option<f64>,
}

/// What a name stands for.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Datum {
    Tool(ToolData),
    Base(Isometry3<f64>),
    /// m/s.
    Speed(f64),
    Zone(Zone),
    Target(Target),
    Joints([f64; 6], Option<f64>),
    /// A number, for offsets.
    Number(f64),
}

/// Data by name in small letters, with the line.
#[derive(Debug, Default)]
pub(super) struct Data(BTreeMap<String, (Datum, usize)>);

impl Data {
    pub fn insert(
        &mut self,
        name: &str,
        datum: Datum,
        line: usize,
    ) -> Result<(), ProgramErrorKind> {
        match self.0.insert(name.to_lowercase(), (datum, line)) {
            None => Ok(()),
            Some((_, first_line)) => Err(ProgramErrorKind::Twice {
                what: name.to_owned(),
                first_line,
            }),
        }
    }

    /// Declared data, or data that the language has by name.
    pub fn find(&self, name: &str) -> Option<Datum> {
        let name = name.to_lowercase();
        if let Some((datum, _)) = self.0.get(&name) {
            return Some(datum.clone());
        }
        match name.as_str() {
            "tool0" => Some(Datum::Tool(ToolData {
                flange_from_tool: Isometry3::identity(),
                load: ToolLoad {
                    mass_kg: NO_LOAD_KG,
                    centre_m: Vector3::new(0.0, 0.0, 1e-3),
                },
            })),
            "wobj0" => Some(Datum::Base(Isometry3::identity())),
            "vmax" => Some(Datum::Speed(MAX_M_PER_S)),
            "fine" => Some(Datum::Zone(Zone::Stop)),
            _ => {
                let speed = name.strip_prefix('v').and_then(|n| n.parse::<u32>().ok());
                let speed = speed.filter(|mm_per_s| SPEEDS.contains(mm_per_s));
                let speed = speed.map(|mm_per_s| Datum::Speed(f64::from(mm_per_s) * 1e-3));
                speed.or_else(|| zone_radius_m(&name).map(|m| Datum::Zone(Zone::Within(m))))
            }
        }
    }

    /// A number, or the name of one.
    pub fn number(&self, value: &Value, what: &str) -> Result<f64, ProgramErrorKind> {
        if let Value::Word(name) = value
            && let Some(Datum::Number(number)) = self.find(name.trim_start_matches('-'))
        {
            return Ok(if name.starts_with('-') {
                -number
            } else {
                number
            });
        }
        value.number(what)
    }
}

/// Reads a value of a type; `None` if the type has no use here.
pub(super) fn datum(
    kind: &str,
    name: &str,
    value: &Value,
) -> Result<Option<Datum>, ProgramErrorKind> {
    Ok(Some(match kind.to_lowercase().as_str() {
        "tooldata" => Datum::Tool(tool(name, value)?),
        "wobjdata" => Datum::Base(base(name, value)?),
        "speeddata" => Datum::Speed(speed(name, value)?),
        "zonedata" => Datum::Zone(zone(name, value)?),
        "robtarget" => Datum::Target(target(name, value)?),
        "jointtarget" => {
            let (joints, turntable) = joints(name, value)?;
            Datum::Joints(joints, turntable)
        }
        "num" => Datum::Number(value.number(name)?),
        _ => return Ok(None),
    }))
}

fn tool(name: &str, value: &Value) -> Result<ToolData, ProgramErrorKind> {
    let parts = value.parts(name, 3)?;
    truth(name, &parts[0], "TRUE")?;
    let load = parts[2].parts("tload", 6)?;
    attitude("aom", &load[2])?;
    for moment in &load[3..] {
        moment.number("a moment of inertia")?;
    }
    Ok(ToolData {
        flange_from_tool: frame("tframe", &parts[1])?,
        load: ToolLoad {
            mass_kg: load[0].number("mass")?,
            centre_m: Vector3::from(load[1].numbers::<3>("cog")?) * 1e-3,
        },
    })
}

fn base(name: &str, value: &Value) -> Result<Isometry3<f64>, ProgramErrorKind> {
    let parts = value.parts(name, 5)?;
    truth("robhold", &parts[0], "FALSE")?;
    truth("ufprog", &parts[1], "TRUE")?;
    ProgramErrorKind::unless(parts[2] == Value::Text, "ufmec", "no text", "a text")?;
    Ok(frame("uframe", &parts[3])? * frame("oframe", &parts[4])?)
}

pub(super) fn speed(name: &str, value: &Value) -> Result<f64, ProgramErrorKind> {
    let [tcp, _, _, _] = value.numbers::<4>(name)?;
    ProgramErrorKind::unless(tcp > 0.0, "v_tcp", tcp, "above zero")?;
    Ok(tcp * 1e-3)
}

pub(super) fn zone(name: &str, value: &Value) -> Result<Zone, ProgramErrorKind> {
    let parts = value.parts(name, 7)?;
    if let Value::Word(word) = &parts[0]
        && word.eq_ignore_ascii_case("TRUE")
    {
        return Ok(Zone::Stop);
    }
    truth("finep", &parts[0], "FALSE")?;
    let mm = parts[1].number("pzone_tcp")?;
    ProgramErrorKind::unless(mm >= 0.0, "pzone_tcp", mm, "zero or above")?;
    Ok(if mm > 0.0 {
        Zone::Within(mm * 1e-3)
    } else {
        Zone::Stop
    })
}

pub(super) fn target(name: &str, value: &Value) -> Result<Target, ProgramErrorKind> {
    let parts = value.parts(name, 4)?;
    let mut quadrants = [0; 4];
    for (quadrant, part) in quadrants.iter_mut().zip(parts[2].parts("robconf", 4)?) {
        let number = part.number("robconf")?;
        let fits = number.fract() == 0.0 && number.abs() <= 100.0;
        ProgramErrorKind::unless(fits, "robconf", number, "a whole number")?;
        *quadrant = number as i32;
    }
    let [cf1, cf4, cf6, cfx] = quadrants;
    let confdata = Confdata { cf1, cf4, cf6, cfx };
    confdata.check()?;
    Ok(Target {
        pose: Isometry3::from_parts(
            Translation3::from(Vector3::from(parts[0].numbers::<3>("trans")?) * 1e-3),
            attitude("rot", &parts[1])?,
        ),
        confdata,
        turntable_deg: turntable(&parts[3])?,
    })
}

/// Joints, and the turntable, deg.
pub(super) fn joints(
    name: &str,
    value: &Value,
) -> Result<([f64; 6], Option<f64>), ProgramErrorKind> {
    let parts = value.parts(name, 2)?;
    Ok((parts[0].numbers::<6>("robax")?, turntable(&parts[1])?))
}

fn turntable(value: &Value) -> Result<Option<f64>, ProgramErrorKind> {
    let axes = value.numbers::<6>("extax")?;
    if let Some(used) = axes[1..].iter().find(|axis| **axis != UNUSED_AXIS) {
        return Err(ProgramErrorKind::value(
            "an external axis after eax_a",
            used,
            "9E+09: a turntable on eax_a is all that is read",
        ));
    }
    Ok((axes[0] != UNUSED_AXIS).then_some(axes[0]))
}

fn truth(what: &str, value: &Value, wanted: &str) -> Result<(), ProgramErrorKind> {
    match value {
        Value::Word(word) if word.eq_ignore_ascii_case(wanted) => Ok(()),
        Value::Word(word) => Err(ProgramErrorKind::value(what, word, wanted)),
        _ => Err(ProgramErrorKind::value(what, "no word", wanted)),
    }
}

fn frame(what: &str, value: &Value) -> Result<Isometry3<f64>, ProgramErrorKind> {
    let parts = value.parts(what, 2)?;
    let mm = Vector3::from(parts[0].numbers::<3>(what)?);
    let rotation = attitude(what, &parts[1])?;
    Ok(Isometry3::from_parts(
        Translation3::from(mm * 1e-3),
        rotation,
    ))
}

fn attitude(what: &str, value: &Value) -> Result<UnitQuaternion<f64>, ProgramErrorKind> {
    let [w, x, y, z] = value.numbers::<4>(what)?;
    let quaternion = Quaternion::new(w, x, y, z);
    let square = quaternion.norm_squared();
    let what = format!("the sum of squares of {what}");
    ProgramErrorKind::unless((square - 1.0).abs() <= UNIT, what, square, "1, to 2e-4")?;
    Ok(UnitQuaternion::from_quaternion(quaternion))
}
