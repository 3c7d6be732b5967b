//! Obstacles and clearances: shapes, meshes, poses, plans.

mod arm_meshes;
mod common;
mod documents;
mod mesh;
mod planned;
mod pose;
mod scene;
mod self_clearance;
mod tool;
