//! Cost of brushing an edge of the mould block, 12.2 s of which 6 s in touch, by the triangles that
//! the block is cut into.

#[path = "../tests/support/halved.rs"]
mod halved;

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use halved::halved;
use std::path::Path;
use std::time::Duration;
use truecut_plan::surface::{Mesh, MeshUse};
use truecut_scenario::Scenario;
use truecut_sim::run::{Claims, Run};

/// Halvings of every side: each makes four triangles of one, of the twelve of a block.
const HALVINGS: [usize; 2] = [0, 5];

fn seconds(c: &mut Criterion) {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let shipped = root.join("scenarios/finishing/block_edge_brush.toml");
    let block = root.join("assets/surfaces/mould_block.obj");
    let block = Mesh::load(&block, 1e-3, MeshUse::Body).expect("the asset");
    let folder = tempfile::tempdir().expect("a folder");
    let mut group = c.benchmark_group("brushed edge, 12.2 s, triangles");
    group.sample_size(10);
    for halvings in HALVINGS {
        let file = folder.path().join(format!("block{halvings}.obj"));
        let (text, triangles) = halved(&block, halvings, 0.02);
        std::fs::write(&file, text).expect("written");
        let mesh = file.to_str().expect("a name").to_owned();
        let overrides = [("process.brush.workpiece.mesh".to_owned(), mesh)];
        let text = std::fs::read_to_string(&shipped).expect("shipped");
        let text = text.split("[[claim]]").next().expect("a first part");
        let scenario = Scenario::from_str(&shipped, text, &overrides).expect("overrides");
        let run_once = || {
            let run = Run {
                claims: Claims::Ignore,
                ..Run::of(&scenario)
            };
            Duration::from_secs_f64(run.execute().expect("a run").run_s)
        };
        group.bench_function(BenchmarkId::from_parameter(triangles), |b| {
            b.iter_custom(|times| (0..times).map(|_| run_once()).sum());
        });
    }
    group.finish();
}

criterion_group!(brushed, seconds);
criterion_main!(brushed);
