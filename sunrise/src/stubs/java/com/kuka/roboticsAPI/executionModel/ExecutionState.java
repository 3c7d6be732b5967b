package com.kuka.roboticsAPI.executionModel;

/** A stub of ours: see src/stubs/README.md. */
public interface ExecutionState {
}
