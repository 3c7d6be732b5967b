//! Repeat blocks as loops of the exported program.

use std::{fmt::Write as _, ops::Range};

use iiwa_program::RepeatBlock;

use super::literal::comment;

/// Names that loop variables may have.
pub(super) const LOOP_VARIABLES: [&str; 8] =
    ["round", "round2", "round3", "round4", "round5", "round6", "round7", "round8"];

/// A statement, which may be a loop over several lines.
#[derive(Clone, PartialEq)]
pub(super) struct ExportedStatement {
    pub(super) text: String,
    /// Number of statements, inner ones included.
    pub(super) size: usize,
}

/// Statements of a program before loops are written.
pub(super) struct UnrolledProgram<'a> {
    /// Statements in order.
    pub(super) statements: &'a [String],
    /// For each motion of the program, the index of its first statement; then the number of
    /// statements.
    pub(super) starts: &'a [usize],
    /// Largest number of statements in a loop, which stays in one method.
    pub(super) max_size: usize,
    /// Indentation of the statements.
    pub(super) indent: usize,
}

impl UnrolledProgram<'_> {
    /// Statements with loops in place of consecutive rounds of a block that have the same
    /// statements. The first and the last round may differ, because the robot stops there or
    /// attaches a tool.
    pub(super) fn with_loops(&self, blocks: &[RepeatBlock]) -> Vec<ExportedStatement> {
        let motions = self.starts.len().saturating_sub(1);
        let before_first = self.starts.first().copied().unwrap_or_default();
        let mut statements = self.plain(0..before_first);
        statements.extend(self.statements_of(0..motions, blocks, 0));
        statements
    }

    fn plain(&self, range: Range<usize>) -> Vec<ExportedStatement> {
        let texts = self.statements.get(range).unwrap_or_default();
        texts.iter().map(|text| ExportedStatement { text: text.clone(), size: 1 }).collect()
    }

    /// Statements of some motions, in which the places of `blocks` count from the first one.
    fn statements_of(
        &self,
        motions: Range<usize>,
        blocks: &[RepeatBlock],
        depth: usize,
    ) -> Vec<ExportedStatement> {
        let mut statements = Vec::new();
        let mut next = motions.start;
        for block in blocks {
            let Range { start, end } = block.range(motions.start);
            if block.motions == 0 || start < next || end > motions.end {
                // The program has been changed since.
                continue;
            }
            statements.extend(self.plain(self.starts[next]..self.starts[start]));
            next = end;
            let rounds: Vec<_> = (start..end)
                .step_by(block.motions)
                .map(|round| {
                    self.statements_of(round..round + block.motions, &block.inner, depth + 1)
                })
                .collect();
            let mut is_named = false;
            for same in rounds.chunk_by(|a, b| a == b) {
                match self.looped(same, block, depth, is_named) {
                    Some(statement) => {
                        is_named = true;
                        statements.push(statement);
                    }
                    None => statements.extend(same.iter().flatten().cloned()),
                }
            }
        }
        statements.extend(self.plain(self.starts[next]..self.starts[motions.end]));
        statements
    }

    /// Loop over rounds with the same statements; `None` for a single round or one that is too
    /// long for a method.
    fn looped(
        &self,
        rounds: &[Vec<ExportedStatement>],
        block: &RepeatBlock,
        depth: usize,
        is_named: bool,
    ) -> Option<ExportedStatement> {
        let [round, _, ..] = rounds else { return None };
        let size = 1 + round.iter().map(|statement| statement.size).sum::<usize>();
        let variable = LOOP_VARIABLES.get(depth)?;
        if round.is_empty() || size > self.max_size {
            return None;
        }
        let (indent, count) = (" ".repeat(self.indent), rounds.len());
        let mut text = String::new();
        let remarks = [&block.label.name, &block.label.comment].into_iter().flatten();
        for line in remarks.flat_map(|remark| remark.lines()).filter(|_| !is_named) {
            let line = comment(line.replace('\t', " ").trim_end());
            let _ = writeln!(text, "{indent}// {line}");
        }
        let _ = writeln!(
            text,
            "{indent}for (int {variable} = 0; {variable} < {count}; {variable}++) {{"
        );
        for line in round.iter().flat_map(|statement| statement.text.lines()) {
            let _ = writeln!(text, "    {line}");
        }
        let _ = write!(text, "{indent}}}");
        Some(ExportedStatement { text, size })
    }
}
