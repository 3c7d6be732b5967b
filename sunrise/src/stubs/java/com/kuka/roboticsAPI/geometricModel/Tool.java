package com.kuka.roboticsAPI.geometricModel;

/** Stub of the KUKA type: see src/stubs/README.md. */
public interface Tool {
    void attachTo(ObjectFrame frame);

    ObjectFrame getDefaultMotionFrame();

    ObjectFrame getFrame(String path);
}
