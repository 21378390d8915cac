//! A position in the tree of names, from which a network takes its tensors.

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::fmt::Display;

use candle_core::{DType, Device, Tensor};

use super::Weights;
use crate::{Machine, StableError};

/// Names and shapes that a network asked for.
#[derive(Debug, Default)]
pub(super) struct RequestedTensors(RefCell<BTreeMap<String, Vec<usize>>>);

impl RequestedTensors {
    /// All names and shapes.
    pub fn all(&self) -> Vec<(String, Vec<usize>)> {
        let asked = self.0.borrow();
        asked.iter().map(|(n, s)| (n.clone(), s.clone())).collect()
    }
}

/// Treatment of a request.
#[derive(Clone, Copy)]
enum Mode<'a> {
    /// The request is recorded, and a placeholder that takes no memory is given.
    Checking(&'a RequestedTensors),
    /// The tensor is read.
    Reading(&'a Machine),
}

/// A prefix of names.
#[derive(Clone)]
pub(crate) struct Names<'a> {
    weights: &'a Weights,
    mode: Mode<'a>,
    prefix: String,
}

impl<'a> Names<'a> {
    pub(super) fn checking(weights: &'a Weights, asked: &'a RequestedTensors) -> Self {
        Self {
            weights,
            mode: Mode::Checking(asked),
            prefix: String::new(),
        }
    }

    pub(super) fn reading(weights: &'a Weights, machine: &'a Machine) -> Self {
        Self {
            weights,
            mode: Mode::Reading(machine),
            prefix: String::new(),
        }
    }

    /// The names below `name`.
    pub fn at(&self, name: impl Display) -> Self {
        let prefix = match self.prefix.as_str() {
            "" => name.to_string(),
            prefix => format!("{prefix}.{name}"),
        };
        Self {
            prefix,
            ..self.clone()
        }
    }

    /// The names below the first of `names` for which the weights have `leaf`; below the first one if they have none.
    pub fn at_any(&self, names: &[&str], leaf: &str) -> Self {
        let mut all = names.iter().map(|n| self.at(n));
        let found = all.clone().find(|n| n.has(leaf));
        found.or_else(|| all.next()).unwrap_or_else(|| self.clone())
    }

    /// Whether the weights have this tensor.
    pub fn has(&self, leaf: &str) -> bool {
        self.weights.has(&self.at(leaf).prefix)
    }

    /// The tensor `leaf` of this shape.
    pub fn tensor(&self, leaf: &str, shape: &[usize]) -> Result<Tensor, StableError> {
        let name = self.at(leaf).prefix;
        match self.mode {
            Mode::Reading(machine) => self.weights.read(&name, machine),
            Mode::Checking(asked) => {
                asked.0.borrow_mut().insert(name, shape.to_vec());
                Ok(Tensor::zeros((), DType::F32, &Device::Cpu)?.broadcast_as(shape)?)
            }
        }
    }

    /// The matrix `leaf` of this shape. It may be stored with trailing dimensions of 1, as the kernel of a 1x1
    /// convolution is.
    pub fn matrix(&self, leaf: &str, [rows, columns]: [usize; 2]) -> Result<Tensor, StableError> {
        let stored = self.weights.shape(&self.at(leaf).prefix);
        let as_kernel = [rows, columns, 1, 1];
        if stored == Some(&as_kernel) {
            return Ok(self.tensor(leaf, &as_kernel)?.reshape((rows, columns))?);
        }
        self.tensor(leaf, &[rows, columns])
    }
}
