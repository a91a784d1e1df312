mod arc;
mod hostile;
mod joint;
mod mixed;
mod spline;
mod support;
mod tool;
