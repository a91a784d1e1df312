use pulp::Arch;

use super::*;
use crate::test_arms::random;
use crate::timing::jerk::rows::Counts;

const COUNTS: Counts = Counts {
    jerk: 3,
    acceleration: 3,
    torque: 3,
    tool: true,
};

fn blocks(state: &mut u64, middle: f64, reach: f64) -> Block {
    std::array::from_fn(|_| middle + reach * random(state))
}

/// Rows with all coefficients anywhere, at which points with a near 1 have room.
fn rows(state: &mut u64) -> Rows {
    let mut rows = Rows::new(2, COUNTS);
    for row in &mut rows.jerk.rows {
        *row = [(); 3].map(|()| blocks(state, 0.0, 0.1));
    }
    for row in &mut rows.acceleration.rows {
        *row = [(); 2].map(|()| blocks(state, 0.0, 0.2));
    }
    for row in &mut rows.torque.rows {
        let small = [(); 3].map(|()| blocks(state, 0.0, 0.1));
        let rooms = [(); 2].map(|()| blocks(state, 1.0, 0.4));
        *row = [small[0], small[1], small[2], rooms[0], rooms[1]];
    }
    for row in &mut rows.tool.rows {
        *row = [
            blocks(state, 0.1, 0.05),
            blocks(state, 0.0, 0.04),
            blocks(state, 0.1, 0.05),
        ];
    }
    for row in &mut rows.speed.rows {
        *row = [blocks(state, 0.3, 0.1)];
    }
    rows
}

fn points(state: &mut u64, middle: f64, reach: f64) -> Vec<Point> {
    let point = |state: &mut u64| {
        [
            blocks(state, middle, reach),
            blocks(state, 0.0, reach),
            blocks(state, 0.0, reach),
        ]
    };
    vec![point(state), point(state)]
}

/// Everything that one assembly needs and leaves.
struct Assembled {
    moved: PerRow,
    inverse: PerRow,
    normals: Vec<Normal>,
    negative: f64,
}

fn assemble(rows: &Rows, points: &[Point], scale: &[Block], multipliers: &PerRow) -> Assembled {
    let still = PerRow::new(rows);
    let mut assembled = Assembled {
        moved: PerRow::new(rows),
        inverse: PerRow::new(rows),
        normals: vec![
            Normal {
                hessian: [ZERO; 6],
                pull: [ZERO; 3],
                gap: ZERO,
            };
            rows.blocks
        ],
        negative: 0.0,
    };
    assembled.negative = Arch::new().dispatch(Assemble {
        rows,
        points,
        scale,
        multipliers,
        step: &still,
        dual_step: 0.0,
        moved: &mut assembled.moved,
        inverse: &mut assembled.inverse,
        normals: &mut assembled.normals,
    });
    assembled
}

fn all(rows: &Rows, value: f64) -> PerRow {
    let mut per_row = PerRow::new(rows);
    per_row.fill(value);
    per_row
}

/// Block and lane of every sample.
fn lanes() -> impl Iterator<Item = (usize, usize)> {
    (0..2 * LANES_MAX).map(|sample| (sample / LANES_MAX, sample % LANES_MAX))
}

fn shifted(points: &[Point], axis: usize, by: f64) -> Vec<Point> {
    let mut points = points.to_vec();
    for point in &mut points {
        point[axis] = point[axis].map(|value| value + by);
    }
    points
}

/// With all multipliers 1 the gap is Σ z and the pull is Σ ∇z: central differences of one give the other.
#[test]
fn gradients_are_those_of_the_slacks() {
    let state = &mut 4;
    let rows = rows(state);
    let scale = [blocks(state, 1.0, 0.3), blocks(state, 1.0, 0.3)];
    let points = points(state, 1.0, 0.3);
    let one = all(&rows, 1.0);
    let here = assemble(&rows, &points, &scale, &one);
    assert!(here.negative < 0.0);
    let step = 1e-5;
    for axis in 0..3 {
        let [after, before] = [step, -step].map(|by| assemble(&rows, &shifted(&points, axis, by), &scale, &one));
        for (block, lane) in lanes() {
            let difference = (after.normals[block].gap[lane] - before.normals[block].gap[lane]) / (2.0 * step);
            let gradient = here.normals[block].pull[axis][lane];
            assert!((difference - gradient).abs() < 1e-8, "{axis} {difference} {gradient}");
        }
    }
}

/// The tangent of a jerk row is nowhere above the row: what a linearised row allows, the true one does.
#[test]
fn tangents_of_jerk_rows_are_on_the_safe_side() {
    let state = &mut 6;
    let mut rows = Rows::new(
        1,
        Counts {
            jerk: 1,
            acceleration: 0,
            torque: 0,
            tool: false,
        },
    );
    rows.jerk.rows[0] = [(); 3].map(|()| blocks(state, 0.0, 0.2));
    let scale = [[1.0; LANES_MAX]];
    let here = [[
        blocks(state, 1.0, 0.5),
        blocks(state, 0.0, 1.0),
        blocks(state, 0.0, 1.0),
    ]];
    // of the pair, only the upper row counts
    let mut upper = PerRow::new(&rows);
    upper.jerk[0][0] = [1.0; LANES_MAX];
    let at_here = assemble(&rows, &here, &scale, &upper);
    for _ in 0..200 {
        let there = [[
            blocks(state, 1.0, 0.95),
            blocks(state, 0.0, 2.0),
            blocks(state, 0.0, 2.0),
        ]];
        let at_there = assemble(&rows, &there, &scale, &upper);
        for lane in 0..LANES_MAX {
            let normal = &at_here.normals[0];
            let change: f64 = (0..3)
                .map(|k| normal.pull[k][lane] * (there[0][k][lane] - here[0][k][lane]))
                .sum();
            let tangent = normal.gap[lane] + change;
            assert!(tangent <= at_there.normals[0].gap[lane] + 1e-12);
        }
    }
}

/// Predictor and corrector against their formulas, through the products they promise: to first order the affine step
/// takes l·z to 0 and the corrected one to σμ.
#[test]
fn directions_lead_where_they_say() {
    let state = &mut 8;
    let rows = rows(state);
    let scale = [[1.0; LANES_MAX]; 2];
    let points = points(state, 1.0, 0.3);
    let multipliers = all(&rows, 0.7);
    let here = assemble(&rows, &points, &scale, &multipliers);
    let (affine, directions) = (
        vec![[ZERO; 3]; 2],
        vec![
            [
                blocks(state, 0.0, 0.1),
                blocks(state, 0.0, 0.1),
                blocks(state, 0.0, 0.1)
            ];
            2
        ],
    );
    let mut step = PerRow::new(&rows);
    let center = 0.2;
    let [primal, dual] = Arch::new().dispatch(Correct {
        rows: &rows,
        points: &points,
        scale: &scale,
        affine: &affine,
        directions: &directions,
        multipliers: &multipliers,
        inverse: &here.inverse,
        center,
        damping: 1.0,
        step: &mut step,
    });
    // δz of a speed row is −δa/a_max
    for (block, lane) in lanes() {
        let z = 1.0 / here.inverse.speed[block][0][lane];
        let dz = -rows.speed.rows[block][0][lane] * directions[block][0][lane];
        let dl = step.speed[block][0][lane];
        assert!((0.7 * z + 0.7 * dz + z * dl - center).abs() < 1e-12);
        assert!(primal >= -dz / z && dual >= -dl / 0.7);
    }
    let mut seconds = vec![
        Second {
            center: [ZERO; 3],
            cross: [ZERO; 3],
            gap: ZERO,
        };
        2
    ];
    let [_, worst] = Arch::new().dispatch(Predict {
        rows: &rows,
        points: &points,
        scale: &scale,
        directions: &directions,
        multipliers: &multipliers,
        inverse: &here.inverse,
        seconds: &mut seconds,
    });
    // Σ δz·δl = −Σ l·δz − Σ l·δz²/z, and Σ l·δz is the pull along the direction
    for (block, lane) in lanes() {
        let pull: f64 = (0..3)
            .map(|k| here.normals[block].pull[k][lane] * directions[block][k][lane])
            .sum();
        let squares = -seconds[block].gap[lane] - pull;
        assert!(squares > 0.0, "{squares}");
    }
    assert!(worst > 0.0);
}
