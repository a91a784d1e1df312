mod joint;
mod support;
