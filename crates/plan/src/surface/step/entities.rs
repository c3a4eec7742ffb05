//! Entities as points, directions, placements and units.

use nalgebra::Vector3;

use super::part21::{Entity, Fault, Part21, Value};

/// A degree, rad.
const RADIAN_PER_DEG: f64 = std::f64::consts::PI / 180.0;

/// Origin and axes, mm.
#[derive(Debug, Clone, Copy)]
pub(super) struct Frame {
    pub(super) origin: Vector3<f64>,
    pub(super) x: Vector3<f64>,
    pub(super) y: Vector3<f64>,
    pub(super) z: Vector3<f64>,
}

impl Frame {
    /// Coordinates of a point.
    pub(super) fn local(&self, point: &Vector3<f64>) -> Vector3<f64> {
        let way = point - self.origin;
        Vector3::new(way.dot(&self.x), way.dot(&self.y), way.dot(&self.z))
    }

    pub(super) fn at(&self, x: f64, y: f64, z: f64) -> Vector3<f64> {
        self.origin + self.x * x + self.y * y + self.z * z
    }
}

/// A file with its units.
pub(super) struct Model<'a> {
    pub(super) file: &'a Part21<'a>,
    /// Length of the file's unit, mm.
    pub(super) unit_mm: f64,
    /// Its unit of angles, rad.
    pub(super) unit_rad: f64,
}

/// The parameter of a place in a list.
pub(super) fn get<'v>(entity: &Entity, values: &'v [Value], k: usize) -> Result<&'v Value, Fault> {
    let few = || entity.fault(format_args!("parameter {} is missing", k + 1));
    values.get(k).ok_or_else(few)
}

pub(super) fn number(entity: &Entity, value: &Value) -> Result<f64, Fault> {
    match value {
        Value::Number(number) => Ok(*number),
        Value::Typed(_, inner) if inner.len() == 1 => number(entity, &inner[0]),
        _ => Err(entity.fault("a number is expected")),
    }
}

pub(super) fn list<'v>(entity: &Entity, value: &'v Value) -> Result<&'v [Value], Fault> {
    match value {
        Value::List(values) => Ok(values),
        _ => Err(entity.fault("a list is expected")),
    }
}

pub(super) fn reference(entity: &Entity, value: &Value) -> Result<u64, Fault> {
    match value {
        Value::Reference(number) => Ok(*number),
        _ => Err(entity.fault("a reference to an entity is expected")),
    }
}

pub(super) fn is_true(entity: &Entity, value: &Value) -> Result<bool, Fault> {
    match value {
        Value::Name(name) if name == "T" => Ok(true),
        Value::Name(name) if name == "F" => Ok(false),
        _ => Err(entity.fault(".T. or .F. is expected")),
    }
}

pub(super) fn numbers(entity: &Entity, value: &Value) -> Result<Vec<f64>, Fault> {
    let values = list(entity, value)?.iter();
    values.map(|value| number(entity, value)).collect()
}

/// No point of a workpiece lies further off, mm: as of any mesh.
const FARTHEST_MM: f64 = 1e8;

impl<'a> Model<'a> {
    pub(super) fn new(file: &'a Part21<'a>) -> Result<Self, Fault> {
        let mut model = Self {
            file,
            unit_mm: 1.0,
            unit_rad: 1.0,
        };
        // Units stand in a context, a complex entity.
        let complex = file.numbers.iter().filter(|n| file.name(**n).is_none());
        let mut lengths: Vec<f64> = Vec::new();
        for number in complex {
            let context = file.entity(*number)?;
            let Some(values) = context.part("GLOBAL_UNIT_ASSIGNED_CONTEXT") else {
                continue;
            };
            for unit in list(&context, get(&context, values, 0)?)? {
                let unit = file.entity(reference(&context, unit)?)?;
                if unit.part("LENGTH_UNIT").is_some() {
                    lengths.push(1e3 * model.unit(&unit, "METRE")?);
                } else if unit.part("PLANE_ANGLE_UNIT").is_some() {
                    model.unit_rad = model.unit(&unit, "RADIAN")?;
                }
            }
        }
        let Some(first) = lengths.first().copied() else {
            return Err(Fault::new(
                "the file says no unit of length (GLOBAL_UNIT_ASSIGNED_CONTEXT)",
            ));
        };
        if let Some(other) = lengths.iter().find(|other| **other != first) {
            return Err(Fault::new(format!(
                "the file has lengths in two units, of {first} mm and of {other} mm; one is read"
            )));
        }
        model.unit_mm = first;
        Ok(model)
    }

    /// A unit in that of SI.
    fn unit(&self, unit: &Entity, base: &str) -> Result<f64, Fault> {
        if let Some(values) = unit.part("SI_UNIT") {
            let name = |k: usize| match values.get(k) {
                Some(Value::Name(name)) => name.as_str(),
                _ => "",
            };
            let factor = match name(0) {
                "" => 1.0,
                "KILO" => 1e3,
                "DECI" => 1e-1,
                "CENTI" => 1e-2,
                "MILLI" => 1e-3,
                "MICRO" => 1e-6,
                other => return Err(unit.fault(format_args!("prefix {other} is not read"))),
            };
            if name(1) != base {
                return Err(unit.fault(format_args!("{} is expected, not {}", base, name(1))));
            }
            return Ok(factor);
        }
        let Some(values) = unit.part("CONVERSION_BASED_UNIT") else {
            return Err(unit.fault("neither an SI_UNIT nor a CONVERSION_BASED_UNIT"));
        };
        let measure = self.file.entity(reference(unit, get(unit, values, 1)?)?)?;
        let (_, values) = &measure.parts[0];
        let factor = number(&measure, get(&measure, values, 0)?)?;
        let of = self
            .file
            .entity(reference(&measure, get(&measure, values, 1)?)?)?;
        if of.part("SI_UNIT").is_none() {
            return Err(of.fault("a unit that is converted to another one that is no SI_UNIT"));
        }
        let factor = factor * self.unit(&of, base)?;
        let is_angle = base == "RADIAN";
        let is_degree = is_angle && (factor / RADIAN_PER_DEG - 1.0).abs() < 1e-6;
        let factor = if is_degree { RADIAN_PER_DEG } else { factor };
        match factor.is_finite() && factor > 0.0 {
            true => Ok(factor),
            false => Err(measure.fault("a unit must be finite and above 0")),
        }
    }

    /// The entity that a parameter refers to.
    pub(super) fn follow(&self, entity: &Entity, value: &Value) -> Result<Entity, Fault> {
        self.file.entity(reference(entity, value)?)
    }

    /// Parameters of a simple entity of one name.
    pub(super) fn simple<'e>(&self, entity: &'e Entity, name: &str) -> Result<&'e [Value], Fault> {
        entity
            .part(name)
            .ok_or_else(|| entity.fault(format_args!("{name} is expected")))
    }

    fn three(&self, entity: &Entity, name: &str) -> Result<Vector3<f64>, Fault> {
        let values = self.simple(entity, name)?;
        let all = numbers(entity, get(entity, values, 1)?)?;
        match all.as_slice() {
            [x, y, z] => Ok(Vector3::new(*x, *y, *z)),
            _ => Err(entity.fault("three numbers are expected")),
        }
    }

    /// A point, mm.
    pub(super) fn point(&self, number: u64) -> Result<Vector3<f64>, Fault> {
        let entity = self.file.entity(number)?;
        let point = self.three(&entity, "CARTESIAN_POINT")? * self.unit_mm;
        match point.iter().find(|x| x.abs() > FARTHEST_MM) {
            None => Ok(point),
            Some(x) => Err(entity.fault(format!(
                "a coordinate is {x:e} mm, but must be within {FARTHEST_MM:e} mm: no workpiece lies \
                 further out; is the unit right?"
            ))),
        }
    }

    /// Of length 1.
    pub(super) fn direction(&self, number: u64) -> Result<Vector3<f64>, Fault> {
        let entity = self.file.entity(number)?;
        let way = self.three(&entity, "DIRECTION")?;
        way.try_normalize(1e-12)
            .ok_or_else(|| entity.fault("a direction must not be zero"))
    }

    /// An axis of a turn, or a placement of three axes.
    pub(super) fn frame(&self, number: u64) -> Result<Frame, Fault> {
        let entity = self.file.entity(number)?;
        let values = match entity.part("AXIS2_PLACEMENT_3D") {
            Some(values) => values,
            None => self.simple(&entity, "AXIS1_PLACEMENT")?,
        };
        let origin = self.point(reference(&entity, get(&entity, values, 1)?)?)?;
        let way = |k: usize| match values.get(k) {
            Some(Value::Reference(number)) => self.direction(*number).map(Some),
            _ => Ok(None),
        };
        let z = way(2)?.unwrap_or_else(Vector3::z);
        let least = Vector3::ith(z.iamin(), 1.0);
        let towards = way(3)?.unwrap_or(if z.x.abs() < 0.999 {
            Vector3::x()
        } else {
            least
        });
        let across = |way: Vector3<f64>| (way - z * way.dot(&z)).try_normalize(1e-9);
        let parallel = || entity.fault("both of its directions are parallel");
        let x = across(towards).ok_or_else(parallel)?;
        Ok(Frame {
            origin,
            x,
            y: z.cross(&x),
            z,
        })
    }
}
