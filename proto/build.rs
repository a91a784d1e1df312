//! Compiles the schema without `protoc`: one descriptor set feeds the Rust types, the services, the JSON form,
//! reflection and the OpenAPI document.

use std::{
    env,
    error::Error,
    fs,
    path::{Path, PathBuf},
};

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
        .codec_path("crate::codec::Codec")
        .compile_fds(compiler.file_descriptor_set())?;
    write_json_form(&descriptor, &out)
}

/// In these a field that says nothing is left out of the JSON: descriptions come back as they were given, and what was
/// not asked for is not there. Everywhere else zeros and empty lists are written out.
const SPARSE: [&str; 36] = [
    ".takt.v1.RobotDescription",
    ".takt.v1.JointDescription",
    ".takt.v1.JointLimits",
    ".takt.v1.Drive",
    ".takt.v1.Friction",
    ".takt.v1.LinkInertia",
    ".takt.v1.ModelUncertainty",
    ".takt.v1.FittedParameter",
    ".takt.v1.JointResidual",
    ".takt.v1.ModelOrigin",
    ".takt.v1.Payload",
    ".takt.v1.Tool",
    ".takt.v1.Frame",
    ".takt.v1.Pose",
    ".takt.v1.InverseDynamicsResult",
    ".takt.v1.Setpoints",
    ".takt.v1.JointColumns",
    ".takt.v1.PlanPathRequest",
    ".takt.v1.PathLimits",
    ".takt.v1.PathSegment",
    ".takt.v1.Target",
    ".takt.v1.JointSegment",
    ".takt.v1.LineSegment",
    ".takt.v1.ArcSegment",
    ".takt.v1.SplineSegment",
    ".takt.v1.Blend",
    ".takt.v1.PoseTarget",
    ".takt.v1.StreamSetpointsRequest",
    ".takt.v1.PlanBatchRequest",
    ".takt.v1.InverseKinematicsRequest",
    ".takt.v1.EstimateFrictionRequest",
    ".takt.v1.EstimateHeader",
    ".takt.v1.FrictionTerms",
    ".takt.v1.FrictionPrior",
    ".takt.v1.Telemetry",
    ".takt.v1.TelemetryColumns",
];

/// What the generated code reads numbers by; ours is in its place (`src/number.rs`).
const NUMBERS: &str = "::pbjson::private::NumberDeserialize";

fn write_json_form(descriptor: &[u8], out: &Path) -> Result<(), Box<dyn Error>> {
    let builder = || -> Result<pbjson_build::Builder, Box<dyn Error>> {
        let mut builder = pbjson_build::Builder::new();
        builder.preserve_proto_field_names().register_descriptors(descriptor)?;
        Ok(builder)
    };
    let sparse = out.join("sparse");
    fs::create_dir_all(&sparse)?;
    builder()?.out_dir(&sparse).build(&SPARSE)?;
    let mut rest = builder()?;
    rest.emit_fields().exclude(SPARSE).build(&[".takt.v1"])?;
    for folder in [sparse.as_path(), out] {
        let file = folder.join("takt.v1.serde.rs");
        let generated = fs::read_to_string(&file)?;
        fs::write(&file, generated.replace(NUMBERS, "crate::number::Number"))?;
    }
    Ok(())
}
