//! Plan as a table, section by section: CSV or Parquet.

#[cfg(feature = "parquet")]
mod parquet;
mod row;

use std::io::{self, Write};

use iiwa_traj::{MotionDynamics, Section};

use row::{PlanRow, names};

/// Table under construction: a row per sample, at a fixed rate, and a row for the end.
///
/// | columns | content |
/// |---|---|
/// | `t_s` | time since the start of the program, s |
/// | `motion` | the motion's number, from 1 |
/// | `joint_1_rad` ... `joint_7_rad` | positions |
/// | `joint_1_rad_s` ... | velocities |
/// | `joint_1_rad_s2` ... | accelerations |
/// | `tcp_x_m`, `tcp_y_m`, `tcp_z_m` | the TCP of the motion's tool, or the flange, in the base frame of the robot |
/// | `tcp_a_rad`, `tcp_b_rad`, `tcp_c_rad` | orientation of the TCP or flange in the base frame: angles about z, then y, then x, as on the robot |
/// | `torque_1_nm` ... `torque_7_nm` | torques that the joints exert, on the output side of the gears |
///
/// [`JointLog::read`](crate::JointLog::read) reads times and positions back.
#[derive(Debug)]
pub struct PlanTable<W: Write> {
    sheet: Sheet<W>,
    rate_hz: f64,
    /// `true` if the numbers of a CSV table have all digits.
    is_exact: bool,
    dynamics: MotionDynamics,
    /// Number of rows so far.
    ticks: u64,
    /// End of the last section.
    end: Option<PlanRow>,
}

#[derive(Debug)]
enum Sheet<W: Write> {
    Csv(W),
    #[cfg(feature = "parquet")]
    Parquet(Box<parquet::ParquetSheet<W>>),
}

impl<W: Write> PlanTable<W> {
    /// Begins a table with commas between fields, at a rate in rows per second. Numbers are rounded
    /// to 1e-9 of their units (s, rad, m, Nm), unless [`exact`](Self::exact) is called.
    ///
    /// # Errors
    ///
    /// Errors of the stream.
    pub fn csv(mut stream: W, rate_hz: f64) -> io::Result<Self> {
        write!(stream, "t_s,motion")?;
        names().try_for_each(|name| write!(stream, ",{name}"))?;
        writeln!(stream)?;
        Ok(Self::new(Sheet::Csv(stream), rate_hz))
    }

    /// Writes all digits of the numbers of a CSV table, so that they parse back exactly. Numbers of
    /// a Parquet file are always exact.
    #[must_use]
    pub fn exact(mut self) -> Self {
        self.is_exact = true;
        self
    }

    fn new(sheet: Sheet<W>, rate_hz: f64) -> Self {
        Self {
            sheet,
            rate_hz,
            is_exact: false,
            dynamics: MotionDynamics::default(),
            ticks: 0,
            end: None,
        }
    }
}

impl<W: Write + Send> PlanTable<W> {
    /// Begins an Apache Parquet file, compressed by Zstandard, at a rate in rows per second.
    ///
    /// # Errors
    ///
    /// Errors of the stream.
    #[cfg(feature = "parquet")]
    pub fn parquet(stream: W, rate_hz: f64) -> io::Result<Self> {
        Ok(Self::new(Sheet::Parquet(Box::new(parquet::ParquetSheet::new(stream)?)), rate_hz))
    }

    /// Fails: this build lacks the feature `parquet`.
    ///
    /// # Errors
    ///
    /// [`Unsupported`](io::ErrorKind::Unsupported).
    #[cfg(not(feature = "parquet"))]
    pub fn parquet(_stream: W, _rate_hz: f64) -> io::Result<Self> {
        Err(io::Error::new(io::ErrorKind::Unsupported, "this build lacks the feature `parquet`"))
    }

    /// Writes a section; sections must come in order.
    ///
    /// # Errors
    ///
    /// Errors of the stream.
    pub fn section(&mut self, section: &Section) -> io::Result<()> {
        loop {
            let t_s = self.ticks as f64 / self.rate_hz;
            if t_s >= section.end_s() {
                break;
            }
            self.sheet.push(&PlanRow::at(section, t_s, &mut self.dynamics), self.is_exact)?;
            self.ticks += 1;
        }
        self.end = Some(PlanRow::at(section, section.end_s(), &mut self.dynamics));
        Ok(())
    }

    /// Writes the end and returns the stream.
    ///
    /// # Errors
    ///
    /// Errors of the stream.
    pub fn finish(mut self) -> io::Result<W> {
        if let Some(end) = self.end {
            // The last row may already be the end, up to rounding.
            let last = self.ticks.checked_sub(1).map(|tick| tick as f64 / self.rate_hz);
            if last.is_none_or(|last_s| end.t_s - last_s > 1e-9) {
                self.sheet.push(&end, self.is_exact)?;
            }
        }
        match self.sheet {
            Sheet::Csv(mut stream) => {
                stream.flush()?;
                Ok(stream)
            }
            #[cfg(feature = "parquet")]
            Sheet::Parquet(sheet) => sheet.finish(),
        }
    }
}

impl<W: Write + Send> Sheet<W> {
    fn push(&mut self, row: &PlanRow, is_exact: bool) -> io::Result<()> {
        match self {
            Self::Csv(stream) if is_exact => line(stream, row, |value| value),
            Self::Csv(stream) => line(stream, row, rounded),
            #[cfg(feature = "parquet")]
            Self::Parquet(sheet) => sheet.push(row),
        }
    }
}

/// Writes a line of a CSV file. Numbers are the shortest texts that parse back exactly.
fn line(stream: &mut impl Write, row: &PlanRow, number: impl Fn(f64) -> f64) -> io::Result<()> {
    write!(stream, "{:?},{}", number(row.t_s), row.motion)?;
    row.values.iter().try_for_each(|value| write!(stream, ",{:?}", number(*value)))?;
    writeln!(stream)
}

/// Rounds to nine decimals; zero is positive.
fn rounded(value: f64) -> f64 {
    (value * 1e9).round() / 1e9 + 0.0
}
