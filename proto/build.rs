//! Compiles the schema without `protoc`: one descriptor set feeds the Rust types, the services, the JSON form,
//! reflection and the OpenAPI document.

use std::{env, error::Error, fs, path::PathBuf};

fn main() -> Result<(), Box<dyn Error>> {
    println!("cargo:rerun-if-changed=takt");
    let mut compiler = protox::Compiler::new(["."])?;
    compiler
        .include_imports(true)
        .include_source_info(true)
        .open_file("takt/v1/service.proto")?;
    let descriptor = compiler.encode_file_descriptor_set();
    let out = PathBuf::from(env::var("OUT_DIR")?);
    fs::write(out.join("descriptor.bin"), &descriptor)?;
    tonic_prost_build::configure()
        .build_transport(false)
        .compile_fds(compiler.file_descriptor_set())?;
    pbjson_build::Builder::new()
        .preserve_proto_field_names()
        .register_descriptors(&descriptor)?
        .build(&[".takt.v1"])?;
    Ok(())
}
