//! Joint positions as NumPy arrays, without copies where the memory layout allows it.

use std::{
    borrow::Cow,
    ops::{Deref, Range},
};

use iiwa_kin::Joints;
use numpy::{
    AllowTypeChange, Element, IxDyn, PyArray, PyArrayDescrMethods, PyArrayDyn, PyArrayLike,
    PyArrayMethods, PyUntypedArray, PyUntypedArrayMethods,
    ndarray::{ArrayD, Dimension},
};
use pyo3::{
    exceptions::{PyMemoryError, PyTypeError, PyValueError},
    prelude::*,
    types::{PyList, PyTuple},
};

/// Joint positions from Python: (7,) or (n, 7), or anything that NumPy converts to such an array.
pub(crate) type JointsLike<'py> = RealArray<'py, IxDyn>;

/// Real numbers from Python: an array, or anything that NumPy converts to one. Complex numbers and
/// masked values, which NumPy would convert without an error, are refused.
pub(crate) struct RealArray<'py, D: Dimension>(PyArrayLike<'py, f64, D, AllowTypeChange>);

impl<'py, D: Dimension> Deref for RealArray<'py, D> {
    type Target = PyArrayLike<'py, f64, D, AllowTypeChange>;

    fn deref(&self) -> &Self::Target {
        &self.0
    }
}

impl<'a, 'py, D: Dimension + 'py> FromPyObject<'a, 'py> for RealArray<'py, D> {
    type Error = PyErr;

    fn extract(value: Borrowed<'a, 'py, PyAny>) -> PyResult<Self> {
        check_real(&value)?;
        value.extract().map(Self)
    }
}

/// Refuses complex numbers and masked values.
fn check_real(value: &Bound<'_, PyAny>) -> PyResult<()> {
    let py = value.py();
    let check_kind = |array: &Bound<'_, PyUntypedArray>| match array.dtype().kind() {
        b'c' => {
            Err(PyTypeError::new_err("the array has complex numbers; real numbers are expected"))
        }
        _ => Ok(()),
    };
    if let Ok(array) = value.cast::<PyUntypedArray>() {
        let is_plain = value.get_type().is(py.get_type::<PyUntypedArray>());
        if !is_plain && py.import("numpy.ma")?.call_method1("is_masked", (value,))?.is_truthy()? {
            return Err(PyTypeError::new_err(
                "the array has masked values; fill them or leave them out",
            ));
        }
        return check_kind(array);
    }
    if value.is_instance_of::<PyList>() || value.is_instance_of::<PyTuple>() {
        // NumPy itself refuses complex numbers of Python.
        for entry in value.try_iter()? {
            let entry = entry?;
            if entry.cast::<PyUntypedArray>().is_ok() {
                check_real(&entry)?;
            }
        }
        return Ok(());
    }
    // Such as a table of pandas.
    match py.import("numpy")?.call_method1("asarray", (value,))?.cast::<PyUntypedArray>() {
        Ok(array) => check_kind(array),
        Err(_) => Ok(()),
    }
}

/// Rows of seven numbers.
pub(crate) struct Rows<'a> {
    pub(crate) joints: Cow<'a, [Joints]>,
    /// `true` for a single row, of shape (7,).
    pub(crate) is_single: bool,
}

impl<'a> Rows<'a> {
    /// The rows of an array called `name`, all finite.
    pub(crate) fn new(name: &str, array: &'a JointsLike<'_>) -> PyResult<Self> {
        let rows = Self::unchecked(name, array)?;
        rows.check(name, 0..rows.joints.len())?;
        Ok(rows)
    }

    /// The rows of an array called `name`, for callers that check them later, by [`Self::check`].
    pub(crate) fn unchecked(name: &str, array: &'a JointsLike<'_>) -> PyResult<Self> {
        let is_single = match array.shape() {
            [7] => true,
            [_, 7] => false,
            shape => {
                return Err(PyValueError::new_err(format!(
                    "{name} has the shape {shape:?}; (7,) or (n, 7) is expected"
                )));
            }
        };
        // NumPy's memory may be in column order.
        let slice = array.as_slice().ok().filter(|_| array.is_c_contiguous());
        let joints = if let Some(slice) = slice {
            Cow::Borrowed(slice.as_chunks().0)
        } else {
            let rows = array.as_array();
            let mut joints = room(rows.len() / 7)?;
            joints.extend(rows.rows().into_iter().map(|row| std::array::from_fn(|j| row[j])));
            Cow::Owned(joints)
        };
        Ok(Self { joints, is_single })
    }

    /// Checks that some of the rows are finite.
    pub(crate) fn check(&self, name: &str, some: Range<usize>) -> PyResult<()> {
        let (first, some) = (some.start, &self.joints[some]);
        // First all rows without a branch, which takes a fraction of the time of finding the row.
        if some.as_flattened().iter().fold(true, |all, value| all & value.is_finite()) {
            return Ok(());
        }
        let bad = some.iter().position(|row| !row.iter().all(|value| value.is_finite()));
        match bad.map(|row| first + row) {
            None => Ok(()),
            Some(_) if self.is_single => {
                Err(PyValueError::new_err(format!("{name} contains a value that is not finite")))
            }
            Some(row) => Err(PyValueError::new_err(format!(
                "{name} contains a value that is not finite in row {row}"
            ))),
        }
    }

    /// The only row.
    pub(crate) fn single(&self, name: &str) -> PyResult<&Joints> {
        match (&*self.joints, self.is_single) {
            ([only], true) => Ok(only),
            _ => Err(PyValueError::new_err(format!("{name} has to be of the shape (7,)"))),
        }
    }
}

/// An empty vector with capacity `count`, or a `MemoryError`: the caller chooses the size.
pub(crate) fn room<T>(count: usize) -> PyResult<Vec<T>> {
    let mut list = Vec::new();
    list.try_reserve_exact(count)
        .map_err(|_| PyMemoryError::new_err(format!("not enough memory for {count} rows")))?;
    Ok(list)
}

/// An array with `inner` as its last dimensions, and (n,) before them unless it is of a single row.
pub(crate) fn array<'py, const WIDTH: usize>(
    py: Python<'py>,
    rows: Vec<[f64; WIDTH]>,
    inner: &[usize],
    is_single: bool,
) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
    let count = rows.len();
    let shape: Vec<usize> =
        (!is_single).then_some(count).into_iter().chain(inner.iter().copied()).collect();
    let array = ArrayD::from_shape_vec(IxDyn(&shape), rows.into_flattened())
        .map_err(|error| PyValueError::new_err(error.to_string()))?;
    Ok(PyArrayDyn::from_owned_array(py, array))
}

/// An array (n, 7).
pub(crate) fn joint_array(py: Python<'_>, rows: Vec<Joints>) -> PyResult<Py<PyArrayDyn<f64>>> {
    array(py, rows, &[7], false).map(Bound::unbind)
}

/// Makes an array read-only, as all callers of a getter share it.
pub(crate) fn shared<T: Element, D: Dimension>(
    array: Bound<'_, PyArray<T, D>>,
) -> Py<PyArray<T, D>> {
    array.readwrite().make_nonwriteable();
    array.unbind()
}
