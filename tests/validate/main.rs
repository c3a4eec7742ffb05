//! Against measured data of real machines. The data is not part of the project: the folder that holds it is
//! named in `TRUECUT_DATA`, and without it each test says that it is skipped.

mod emps;
mod inverse;
mod support;
mod turning;
mod ur10e;
