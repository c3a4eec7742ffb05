//! Definitions of common messages, for files that hold none: bags that were converted from those of
//! older recorders, which stored names of types only.
//!
//! They are those of ROS 2's `common_interfaces`, without comments.

/// Types of which the definition is known, by their names without `msg/`.
const KNOWN: [(&str, &str); 5] = [
    (
        "sensor_msgs/JointState",
        "std_msgs/Header header\nstring[] name\nfloat64[] position\nfloat64[] velocity\nfloat64[] effort\n",
    ),
    (
        "geometry_msgs/WrenchStamped",
        "std_msgs/Header header\ngeometry_msgs/Wrench wrench\n",
    ),
    (
        "sensor_msgs/Imu",
        "std_msgs/Header header\n\
         geometry_msgs/Quaternion orientation\nfloat64[9] orientation_covariance\n\
         geometry_msgs/Vector3 angular_velocity\nfloat64[9] angular_velocity_covariance\n\
         geometry_msgs/Vector3 linear_acceleration\nfloat64[9] linear_acceleration_covariance\n",
    ),
    (
        "geometry_msgs/PoseStamped",
        "std_msgs/Header header\ngeometry_msgs/Pose pose\n",
    ),
    ("std_msgs/Float64", "float64 data\n"),
];

/// What they refer to, as a file writes it behind the message itself.
pub(super) const PARTS: &str = "\
================================================================================
MSG: std_msgs/Header
builtin_interfaces/Time stamp
string frame_id
================================================================================
MSG: builtin_interfaces/Time
int32 sec
uint32 nanosec
================================================================================
MSG: geometry_msgs/Wrench
geometry_msgs/Vector3 force
geometry_msgs/Vector3 torque
================================================================================
MSG: geometry_msgs/Vector3
float64 x
float64 y
float64 z
================================================================================
MSG: geometry_msgs/Quaternion
float64 x
float64 y
float64 z
float64 w
================================================================================
MSG: geometry_msgs/Pose
geometry_msgs/Point position
geometry_msgs/Quaternion orientation
================================================================================
MSG: geometry_msgs/Point
float64 x
float64 y
float64 z
";

/// The definition of a message, `sensor_msgs/msg/JointState` or without `msg/`.
pub(super) fn of(kind: &str) -> Option<&'static str> {
    let kind = kind.replacen("/msg/", "/", 1);
    let found = KNOWN.iter().find(|(name, _)| *name == kind);
    found.map(|(_, text)| *text)
}

/// The types that are known.
pub(super) fn names() -> Vec<&'static str> {
    KNOWN.iter().map(|(name, _)| *name).collect()
}

/// Units of the numbers below a field of a message, by REP 103 of ROS: SI. What a joint's numbers
/// are depends on whether it turns.
pub(super) fn unit(kind: &str, field: &str) -> Option<&'static str> {
    Some(match (kind, field) {
        ("geometry_msgs/Wrench", "force") => "N",
        ("geometry_msgs/Wrench", "torque") => "N m",
        ("geometry_msgs/Pose", "position") | ("geometry_msgs/Transform", "translation") => "m",
        ("geometry_msgs/Pose", "orientation") | ("geometry_msgs/Transform", "rotation") => "1",
        ("geometry_msgs/Twist", "linear") => "m/s",
        ("geometry_msgs/Twist", "angular") => "rad/s",
        ("geometry_msgs/Accel", "linear") => "m/s^2",
        ("geometry_msgs/Accel", "angular") => "rad/s^2",
        ("sensor_msgs/Imu", "orientation") => "1",
        ("sensor_msgs/Imu", "angular_velocity") => "rad/s",
        ("sensor_msgs/Imu", "linear_acceleration") => "m/s^2",
        _ => return None,
    })
}
