package com.kuka.roboticsAPI.executionModel;

/** Stub of the KUKA type: see src/stubs/README.md. */
public interface IExecutionService {
}
