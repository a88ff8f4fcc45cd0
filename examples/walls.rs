#![allow(clippy::print_stdout, clippy::print_stderr, reason = "it is a program that prints tables")]
use pneumorph::field::{CappedField, CompiledNetwork, DesignBox};
use pneumorph::genome::Bounds;
use pneumorph::math::{
    cpu_seconds,
    random::{Purpose, Stream},
};
use pneumorph::mesh::{MeshSettings, WallSettings, surface_of_field, wall_surfaces};
use pneumorph::surface::{SurfaceQuality, TriangleMesh};
use std::collections::BTreeMap;

fn main() {
    let args: Vec<f64> = std::env::args().skip(1).map(|a| a.parse().unwrap()).collect();
    let (count, mid_edge, edge) = (args[0] as u64, args[1], args[2]);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).use_current_thread().build().unwrap();
    pool.install(|| {
        let stream = Stream::new(1);
        let bounds = Bounds::default();
        let mut reasons: BTreeMap<String, usize> = BTreeMap::new();
        let (mut valid, mut seconds) = (0, vec![]);
        for i in 0..count {
            let genome = bounds.uniform(&mut stream.keyed(Purpose::Creation, 0, i));
            let settings = MeshSettings::default();
            let field = CappedField::new(
                CompiledNetwork::new(&genome.decode()),
                DesignBox::default(),
                settings.rim_radius,
            )
            .unwrap();
            if surface_of_field(&field, &settings).is_err() {
                continue;
            }
            let settings = MeshSettings { edge: mid_edge, ..settings };
            let mid = match surface_of_field(&field, &settings) {
                Ok(mid) => mid,
                Err(e) => {
                    *reasons.entry(format!("fine mid: {}", e.reason)).or_default() += 1;
                    continue;
                }
            };
            valid += 1;
            let start = cpu_seconds();
            let wall = wall_surfaces(&mid, 1.6, &WallSettings { edge, ..Default::default() });
            seconds.push(cpu_seconds() - start);
            let tell = |mesh: &TriangleMesh| {
                let q = SurfaceQuality::of(mesh).unwrap();
                format!("{} tri, genus {}, ratio {:.2}", q.triangles, q.genus, q.radius_ratio_min)
            };
            match wall {
                Ok(wall) => {
                    let exact = mid.area() * 1.6 + 1.6f64.powi(3) * std::f64::consts::PI / 3.0;
                    let v = wall.outer.volume() - wall.chamber.volume();
                    println!(
                        "{i}: {:.2} s ok {} | {} | volume {:+.2} %",
                        seconds.last().unwrap(),
                        tell(&wall.outer),
                        tell(&wall.chamber),
                        100.0 * (v / exact - 1.0)
                    );
                    *reasons.entry("ok".into()).or_default() += 1;
                }
                Err(e) => {
                    println!("{i}: {:.2} s {e} {:.3}", seconds.last().unwrap(), e.violation);
                    *reasons.entry(e.reason).or_default() += 1;
                }
            }
        }
        seconds.sort_by(f64::total_cmp);
        println!(
            "{valid} valid; {reasons:?}; median {:.3} s, worst {:.3} s",
            seconds[seconds.len() / 2],
            seconds.last().unwrap()
        );
    });
}
