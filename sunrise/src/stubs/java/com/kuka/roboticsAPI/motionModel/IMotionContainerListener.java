package com.kuka.roboticsAPI.motionModel;

import com.kuka.roboticsAPI.executionModel.ExecutionState;
import com.kuka.roboticsAPI.executionModel.IExecutionContainer;

/** Stub of the KUKA type: see src/stubs/README.md. */
public interface IMotionContainerListener {
    void onStateChanged(IExecutionContainer container, ExecutionState state);

    void containerFinished(IMotionContainer container);

    void motionStarted(IMotion motion);

    void motionFinished(IMotion motion);
}
