//! The limits of torque in eight cells at once.
//!
//! They stand beside the other limits of these cells: most programs have none. Torque is kept at the start and in the middle
//! of a cell, by the joints that can come near to their limits there.

use std::ops::Range;

use pulp::Simd;

use crate::{
    cells::{LargestDecreases, Sums},
    functionals::{CellState, MiddleV, MiddleX, StartV, StartX},
    lanes::{LANES, Lanes, Vector, registers},
    lowering::Lowering,
    mesh::Mesh,
    quadratic::{Quadratic, Terms},
    slack_pair::{Decreases, InteriorStart, InteriorStep, InteriorSteps, Start},
    torque_rows::TorqueRows,
};

/// At most eight cells; rows of missing ones limit nothing.
#[derive(Clone, Debug)]
pub(crate) struct TorqueBlock {
    /// Which cells, of which some may be there twice.
    cells: [usize; LANES],
    /// How many of them are there once.
    count: usize,
    start: TorqueRows,
    middle: TorqueRows,
}

/// The blocks of all cells in which a joint can come near to its limit of torque.
pub(crate) fn torque_blocks(mesh: &Mesh) -> Vec<TorqueBlock> {
    let near: Vec<(usize, [bool; 7])> = (0..mesh.cells.len())
        .map(|k| (k, mesh.torques.near(k)))
        .filter(|(_, joints)| *joints != [false; 7])
        .collect();
    near.chunks(LANES).map(|cells| TorqueBlock::new(mesh, cells)).collect()
}

impl TorqueBlock {
    fn new(mesh: &Mesh, cells: &[(usize, [bool; 7])]) -> Self {
        let joints: Vec<usize> =
            (0..7).filter(|j| cells.iter().any(|(_, near)| near[*j])).collect();
        let mut block = Self {
            cells: std::array::from_fn(|l| cells[l.min(cells.len() - 1)].0),
            count: cells.len(),
            start: TorqueRows::new(joints.len()),
            middle: TorqueRows::new(joints.len()),
        };
        for (lane, &(k, _)) in cells.iter().enumerate() {
            let Some([start, middle, _]) = mesh.torques.of(k) else { continue };
            let length = mesh.cells[k].length;
            block.start.set(lane, &joints, start, length);
            block.middle.set(lane, &joints, middle, length);
        }
        block
    }

    /// How many sides its limits have.
    pub(crate) fn sides(&self) -> usize {
        LANES * (self.start.sides() + self.middle.sides())
    }

    /// Whether it has a cell in `window`.
    #[inline(always)]
    pub(crate) fn is_in(&self, window: &Range<usize>) -> bool {
        self.cells.iter().any(|cell| window.contains(cell))
    }

    /// Lowers the limits in the cells from `first` on.
    pub(crate) fn lower(&mut self, first: usize, by: &[Lowering]) {
        for (lane, cell) in self.cells[..self.count].iter().enumerate() {
            if let Some(by) = cell.checked_sub(first).and_then(|k| by.get(k)) {
                self.start.scale(lane, by.torque);
                self.middle.scale(lane, by.torque);
            }
        }
    }

    #[inline(always)]
    fn gather(&self, states: &[CellState]) -> [Lanes; 4] {
        std::array::from_fn(|a| Lanes::from_fn(|l| states[self.cells[l]][a]))
    }

    /// Sets slacks to what the limits leave, and duals to go with them.
    #[inline(always)]
    pub(crate) fn start<S: Simd>(&mut self, simd: S, states: &[CellState], start: Start) {
        let lanes = self.gather(states);
        for register in 0..registers::<S>() {
            let y = &lanes.map(|lanes| lanes.load(simd, register));
            let start = &InteriorStart::new(simd, register, start);
            self.start.start::<StartX, StartV, S>(start, y);
            self.middle.start::<MiddleX, MiddleV, S>(start, y);
        }
    }

    /// Goes the last step of slacks and duals, then adds what the limits contribute to the quadratic function that the next
    /// step minimises.
    #[inline(always)]
    pub(crate) fn assemble<S: Simd>(
        &mut self,
        simd: S,
        states: &[CellState],
        [last, next]: [InteriorStep; 2],
        quadratics: &mut [Quadratic],
        sums: &mut Sums,
    ) {
        let lanes = self.gather(states);
        let mut h = [Lanes::default(); 10];
        let mut g = [Lanes::default(); 4];
        let mut gap = Lanes::default();
        for r in 0..registers::<S>() {
            let y = &lanes.map(|lanes| lanes.load(simd, r));
            let sum = &mut Terms::new(simd);
            let steps = &InteriorSteps::new(simd, r, last, next);
            self.start.add::<StartX, StartV, S>(steps, y, sum);
            self.middle.add::<MiddleX, MiddleV, S>(steps, y, sum);
            std::iter::zip(&mut h, sum.h).for_each(|(lanes, h)| lanes.store(r, h));
            std::iter::zip(&mut g, sum.g).for_each(|(lanes, g)| lanes.store(r, g));
            gap.store(r, sum.gap);
            sums.residual = sums.residual.max(sum.residual.largest());
        }
        sums.gap = gap.add_to(sums.gap);
        for (lane, cell) in self.cells[..self.count].iter().enumerate() {
            let Quadratic { h: total_h, g: total_g } = &mut quadratics[*cell];
            std::iter::zip(total_h, &h).for_each(|(total, h)| *total += h.0[lane]);
            std::iter::zip(total_g, &g).for_each(|(total, g)| *total += g.0[lane]);
        }
    }

    /// Finds the steps of slacks that go with the steps `state_steps` of the states.
    #[inline(always)]
    pub(crate) fn find_slack_steps<S: Simd>(
        &mut self,
        simd: S,
        states: &[CellState],
        state_steps: &[CellState],
        mu: f64,
        largest: &mut LargestDecreases,
    ) {
        let (lanes, lane_steps) = (self.gather(states), self.gather(state_steps));
        let mu = Vector::splat(simd, mu);
        for r in 0..registers::<S>() {
            let after: &[_; 4] =
                &std::array::from_fn(|a| lanes[a].load(simd, r) + lane_steps[a].load(simd, r));
            let decreases = &mut Decreases::new(simd);
            self.start.find_steps::<StartX, StartV, S>(r, after, mu, decreases);
            self.middle.find_steps::<MiddleX, MiddleV, S>(r, after, mu, decreases);
            largest.slack = largest.slack.max(decreases.slack.largest());
            largest.dual = largest.dual.max(decreases.dual.largest());
        }
    }
}
