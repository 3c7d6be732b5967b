//! Obstacles and clearances: shapes, meshes, poses, plans.

mod arm_meshes;
mod carried;
mod collada;
mod common;
mod documents;
mod elsewhere;
mod mesh;
mod moved;
mod mutations;
mod obstacles;
mod planned;
mod pose;
mod scene;
mod self_clearance;
mod stl;
mod tool;
