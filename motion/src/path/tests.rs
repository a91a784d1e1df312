mod joint;
mod plan;
mod support;
