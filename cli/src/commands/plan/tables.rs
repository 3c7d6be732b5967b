//! Tables of a plan.

use std::{
    io::{self, BufWriter},
    path::Path,
};

use iiwa_files::{Output, OutputStream};
use iiwa_log::PlanTable;
use iiwa_traj::Section;

use crate::{args::Plan, failure::Failure, output, output_kind::OutputKind};

/// Tables under construction that the options request.
pub(super) struct Tables(Vec<(Output, PlanTable<BufWriter<OutputStream>>)>);

/// Function that begins a table.
type Begin = fn(BufWriter<OutputStream>, f64) -> io::Result<PlanTable<BufWriter<OutputStream>>>;

impl Tables {
    pub(super) fn new(options: &Plan) -> Result<Self, Failure> {
        let begin = |path: &Path, kind: OutputKind, begin: Begin| {
            let output = output::replacing(path, kind)?;
            let table = begin(output.stream()?, options.rate);
            match table {
                Ok(table) => Ok((output, table)),
                Err(error) => Err(Failure::from(output.failure(error))),
            }
        };
        let csv: Begin = if options.exact {
            |stream, rate_hz| PlanTable::csv(stream, rate_hz).map(PlanTable::exact)
        } else {
            PlanTable::csv
        };
        let csv = options.csv.as_deref().map(|path| begin(path, OutputKind::Csv, csv));
        let parquet = options
            .parquet
            .as_deref()
            .map(|path| begin(path, OutputKind::Parquet, PlanTable::parquet));
        csv.into_iter().chain(parquet).collect::<Result<_, _>>().map(Self)
    }

    pub(super) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    pub(super) fn add(&mut self, section: &Section) -> Result<(), Failure> {
        self.0.iter_mut().try_for_each(|(output, table)| {
            Ok(table.section(section).map_err(|error| output.failure(error))?)
        })
    }

    /// Completes the tables and returns their files.
    pub(super) fn finish(self) -> Result<Vec<Output>, Failure> {
        let finish = |(output, table): (Output, PlanTable<BufWriter<OutputStream>>)| {
            let stream = table.finish().map_err(|error| output.failure(error))?;
            stream.into_inner().map_err(|error| output.failure(error.into_error()))?;
            Ok(output)
        };
        self.0.into_iter().map(finish).collect()
    }
}
