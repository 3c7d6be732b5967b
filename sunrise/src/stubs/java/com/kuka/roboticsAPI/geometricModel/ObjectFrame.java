package com.kuka.roboticsAPI.geometricModel;

import com.kuka.roboticsAPI.motionModel.IMotion;
import com.kuka.roboticsAPI.motionModel.IMotionContainer;
import com.kuka.roboticsAPI.motionModel.IMotionContainerListener;

/** A stub of ours: see src/stubs/README.md. */
public interface ObjectFrame extends AbstractFrame {
    IMotionContainer moveAsync(IMotion motion, IMotionContainerListener listener);
}
