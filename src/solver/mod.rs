//! Numbers only: least squares and sparse factorisations. No geometry word appears here.
