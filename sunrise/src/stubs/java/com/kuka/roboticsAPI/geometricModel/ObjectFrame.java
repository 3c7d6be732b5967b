package com.kuka.roboticsAPI.geometricModel;

import com.kuka.roboticsAPI.motionModel.IMotion;
import com.kuka.roboticsAPI.motionModel.IMotionContainer;
import com.kuka.roboticsAPI.motionModel.IMotionContainerListener;

/** Stub of the KUKA type: see src/stubs/README.md. */
public interface ObjectFrame extends AbstractFrame {
    IMotionContainer moveAsync(IMotion motion, IMotionContainerListener listener);
}
