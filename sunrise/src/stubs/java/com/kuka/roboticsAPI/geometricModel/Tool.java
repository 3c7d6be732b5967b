package com.kuka.roboticsAPI.geometricModel;

/** A stub of ours: see src/stubs/README.md. */
public interface Tool {
    void attachTo(ObjectFrame frame);

    ObjectFrame getDefaultMotionFrame();

    ObjectFrame getFrame(String path);
}
