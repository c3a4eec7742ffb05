//! The tables of steady vibration against friction in `docs/physics/vibration.md`, printed to
//! 0.1 µm: for two bare oscillators, and for the whole simulator.

/// Friction over rotating force, and the amplitudes along Y and Z at 300 rpm, µm.
const AT_300_RPM: [(f64, f64, f64); 6] = [
    (0.0, 207.4, 129.8),
    (0.5, 172.3, 110.7),
    (0.7, 136.9, 91.1),
    (0.785, 115.3, 79.2),
    (0.9, 73.9, 56.5),
    (0.95, 46.7, 41.0),
];

/// The same along Y at 400 rpm, near the first natural frequency.
const AT_400_RPM: [(f64, f64); 3] = [(0.0, 1013.1), (0.5, 640.0), (0.9, 134.7)];

/// Holds amplitudes (µm, along Y and Z) at a ratio of friction and rotating force against the table
/// of 300 rpm, to a percent; friction that equals the force holds the oscillator.
pub fn check_300_rpm(steady_um: impl Fn(f64) -> (f64, f64)) {
    for (rho, y_um, z_um) in AT_300_RPM {
        let (y, z) = steady_um(rho);
        println!("rho {rho}: Y {y:.2} ({y_um}), Z {z:.2} ({z_um})");
        assert!(
            (y / y_um - 1.0).abs() < 0.01,
            "rho {rho}: Y {y}, not {y_um}"
        );
        assert!(
            (z / z_um - 1.0).abs() < 0.01,
            "rho {rho}: Z {z}, not {z_um}"
        );
    }
    let (y, z) = steady_um(1.0);
    assert!(y < 0.1 && z < 0.1, "held: {y} {z}");
}

/// The same for the table of 400 rpm.
pub fn check_400_rpm(steady_um: impl Fn(f64) -> (f64, f64)) {
    for (rho, y_um) in AT_400_RPM {
        let (y, _) = steady_um(rho);
        println!("400 rpm, rho {rho}: Y {y:.1} ({y_um})");
        assert!(
            (y / y_um - 1.0).abs() < 0.01,
            "rho {rho}: Y {y}, not {y_um}"
        );
    }
}
