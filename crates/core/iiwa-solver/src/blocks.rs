//! Cells of a section in blocks of eight, sorted by the number of rows that they need.

use std::{cell::RefCell, ops::Range};

use crate::{
    cells::{CellBlock, LimitedCell},
    lanes::LANES,
    limited_segment::LimitedSegment,
    mesh::Mesh,
};

/// Blocks of cells, with one row of each kind at a place on lines and two to eight in curves.
#[derive(Default)]
pub(crate) struct Blocks {
    pub(crate) lines: Vec<CellBlock<1>>,
    pub(crate) two: Vec<CellBlock<2>>,
    pub(crate) three: Vec<CellBlock<3>>,
    pub(crate) four: Vec<CellBlock<4>>,
    pub(crate) five: Vec<CellBlock<5>>,
    pub(crate) seven: Vec<CellBlock<7>>,
    pub(crate) eight: Vec<CellBlock<8>>,
    /// `true` if any cell has rows of further limits.
    pub(crate) has_others: bool,
}

thread_local! {
    /// Released blocks, whose memory is reused.
    static SPARE: RefCell<Blocks> = RefCell::default();
}

/// Runs an expression for each block of some [`Blocks`] that has a cell in the window.
macro_rules! for_each_block {
    ($blocks:expr, $window:expr, $block:ident => $do:expr) => {{
        let (blocks, window) = ($blocks, $window);
        for_each_block!(@ window, $block => $do; &mut blocks.lines);
        for_each_block!(@ window, $block => $do; &mut blocks.two);
        for_each_block!(@ window, $block => $do; &mut blocks.three);
        for_each_block!(@ window, $block => $do; &mut blocks.four);
        for_each_block!(@ window, $block => $do; &mut blocks.five);
        for_each_block!(@ window, $block => $do; &mut blocks.seven);
        for_each_block!(@ window, $block => $do; &mut blocks.eight);
    }};
    (@ $window:ident, $block:ident => $do:expr; $list:expr) => {
        for $block in $list {
            if $block.is_in($window) {
                $do;
            }
        }
    };
}
pub(crate) use for_each_block;

impl Blocks {
    /// Builds blocks of the cells in `list`.
    pub(crate) fn new(segments: &[LimitedSegment<'_>], mesh: &Mesh, list: &[usize]) -> Self {
        let mut of_rows: [Vec<usize>; 7] = Default::default();
        for &k in list {
            let place = match LimitedCell::new(segments, mesh, k).rows() {
                1 if segments[mesh.cells[k].segment].is_line() => 0,
                // Also one row: on curves it has the terms of q'', which blocks of lines leave out.
                ..=2 => 1,
                3 => 2,
                4 => 3,
                5 => 4,
                6 | 7 => 5,
                _ => 6,
            };
            of_rows[place].push(k);
        }
        // A partly filled block takes cells that need fewer rows, except those on lines.
        for place in (2..7).rev() {
            let room = of_rows[place].len().next_multiple_of(8) - of_rows[place].len();
            let fewer = &mut of_rows[place - 1];
            let moved = fewer.split_off(fewer.len() - room.min(fewer.len()));
            of_rows[place].extend(moved);
        }
        let [lines, two, three, four, five, seven, eight] = of_rows;
        let mut new = SPARE.take();
        set(&mut new.lines, segments, mesh, &lines);
        set(&mut new.two, segments, mesh, &two);
        set(&mut new.three, segments, mesh, &three);
        set(&mut new.four, segments, mesh, &four);
        set(&mut new.five, segments, mesh, &five);
        set(&mut new.seven, segments, mesh, &seven);
        set(&mut new.eight, segments, mesh, &eight);
        new.has_others = (0..mesh.cells.len()).any(|k| mesh.rows.near(k).contains(&true));
        new
    }

    /// Releases the memory to the next blocks of this thread. Allocators that keep no free lists by
    /// alignment would allocate new memory for nearly every block.
    pub(crate) fn spare(self) {
        // While a thread ends, the memory is not kept.
        let _ = SPARE.try_with(|spare| spare.replace(self));
    }

    /// Number of sides of the limits in blocks that have a cell in the window.
    pub(crate) fn sides(&self, window: &Range<usize>) -> usize {
        fn of<const J: usize>(blocks: &[CellBlock<J>], window: &Range<usize>) -> usize {
            blocks.iter().filter(|block| block.is_in(window)).map(CellBlock::sides).sum()
        }
        of(&self.lines, window)
            + of(&self.two, window)
            + of(&self.three, window)
            + of(&self.four, window)
            + of(&self.five, window)
            + of(&self.seven, window)
            + of(&self.eight, window)
    }
}

/// Replaces `blocks` by those of the cells in `list`.
fn set<const J: usize>(
    blocks: &mut Vec<CellBlock<J>>,
    segments: &[LimitedSegment<'_>],
    mesh: &Mesh,
    list: &[usize],
) {
    // Set in place: a block has some kilobytes.
    let count = list.len().div_ceil(LANES);
    blocks.truncate(count);
    blocks.resize_with(count, CellBlock::default);
    for (block, cells) in blocks.iter_mut().zip(list.chunks(LANES)) {
        block.set(segments, mesh, cells);
    }
}
