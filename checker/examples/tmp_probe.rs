#![allow(clippy::print_stdout)]
#[path = "common/programs.rs"]
#[allow(dead_code)]
mod programs;
#[path = "common/robots.rs"]
#[allow(dead_code)]
mod robots;
use std::collections::BTreeMap;
use std::time::Instant;
use takt_checker::recheck_path;
use takt_motion::budget::Budget;
use takt_motion::path::outcome::PathOutcome;
use takt_motion::path::plan_path;
fn main() {
    let args: Vec<u64> = std::env::args().skip(1).map(|a| a.parse().unwrap()).collect();
    let robots = robots::all();
    let mut refused: BTreeMap<String, u64> = BTreeMap::new();
    let mut faults: BTreeMap<String, (u64, u64)> = BTreeMap::new();
    let (mut tp, mut tc) = (0.0, 0.0);
    for seed in args[0]..args[1] {
        let (example, request) = programs::of_seed(&robots, seed, args[2] as usize);
        let t = Instant::now();
        let out = plan_path(&example.robot, &request, &Budget::unlimited());
        let dt = t.elapsed().as_secs_f64();
        tp += dt;
        let jerk = request.limit_jerk;
        match out {
            Ok(PathOutcome::Plan(plan)) => {
                let t = Instant::now();
                let report = recheck_path(example.robot.spec(), &request, &plan);
                tc += t.elapsed().as_secs_f64();
                *refused.entry(format!("{} jerk {jerk} PLAN", example.name)).or_default() += 1;
                let mut add = |key: String| { let e = faults.entry(key).or_insert((0, seed)); e.0 += 1; };
                for v in report.violations() { println!("seed {seed} {} jerk {jerk} {:?} {:?} plan {dt:.2}s: {v:?}", example.name, request.sampling, plan.duration); add(format!("{:?} {:?}", v.kind, v.source)); }
                for f in &report.faults { if format!("{:?}", f.kind) == "Use" { let e = &report.extremes[f.index]; println!("   use {:?} {:?} {:?} t {} excess {} claimed margin {}; uses {:?}", e.kind, e.joint, e.source, e.time, e.excess, f.found, plan.limit_uses.iter().filter(|u| (u.kind, u.joint) == (e.kind, e.joint)).map(|u| (u.time, u.value, u.location)).collect::<Vec<_>>()); }
 println!("seed {seed} {} jerk {jerk} {:?}: {f:?}", example.name, request.sampling); add(format!("{:?}", f.kind)); }
            }
            Ok(PathOutcome::Infeasible(i)) => { 
                println!("seed {seed} {} {:?} needed {} avail {} {}", example.name, i.reason, i.needed, i.available, i.suggestion);
                *refused.entry(format!("{} jerk {jerk} {:?}", example.name, i.reason)).or_default() += 1 }
            Err(e) => { let s = format!("{e:?}"); println!("seed {seed} {}", &s[..s.len().min(600)]); *refused.entry(format!("{} FAIL {}", example.name, &s[..s.len().min(60)])).or_default() += 1; }
        }
    }
    for (k, v) in refused { println!("{k}: {v}"); }
    for (k, v) in faults { println!("{k}: {v:?}"); }
    println!("planning {tp:.1} s checking {tc:.1} s");
}
