package iiwasim.sunrise;

import com.kuka.roboticsAPI.applicationModel.IApplicationControl;
import com.kuka.roboticsAPI.applicationModel.IApplicationData;
import com.kuka.roboticsAPI.controllerModel.Controller;
import com.kuka.roboticsAPI.controllerModel.sunrise.ISafetyState;
import com.kuka.roboticsAPI.controllerModel.sunrise.SunriseExecutionService;
import com.kuka.roboticsAPI.controllerModel.sunrise.SunriseSafetyState.SafetyStopType;
import com.kuka.roboticsAPI.deviceModel.JointLimits;
import com.kuka.roboticsAPI.deviceModel.JointPosition;
import com.kuka.roboticsAPI.deviceModel.LBR;
import com.kuka.roboticsAPI.deviceModel.OperationMode;
import com.kuka.roboticsAPI.executionModel.CommandInvalidException;
import com.kuka.roboticsAPI.executionModel.IExecutionService;
import com.kuka.roboticsAPI.geometricModel.Frame;
import com.kuka.roboticsAPI.geometricModel.ObjectFrame;
import com.kuka.roboticsAPI.geometricModel.Tool;
import com.kuka.roboticsAPI.motionModel.IErrorHandler;
import com.kuka.roboticsAPI.motionModel.IMotion;
import com.kuka.roboticsAPI.motionModel.IMotionContainer;
import com.kuka.roboticsAPI.motionModel.IMotionContainerListener;
import com.kuka.roboticsAPI.sensorModel.TorqueSensorData;

import java.util.ArrayList;
import java.util.Collections;
import java.util.List;
import java.util.Map;
import java.util.concurrent.ConcurrentHashMap;

/** A robot whose motions end on request of a test. */
final class FakeRobot implements LBR, IApplicationControl, IApplicationData {
    final List<Container> containers = Collections.synchronizedList(new ArrayList<Container>());
    final Map<String, Point> points = new ConcurrentHashMap<String, Point>();
    volatile SafetyStopType stop = SafetyStopType.NOSTOP;
    volatile OperationMode mode = OperationMode.AUT;
    volatile boolean isReady = true;
    volatile boolean isMastered = true;
    volatile boolean isPaused;
    volatile JointPosition joints = new JointPosition(new double[7]);
    volatile RuntimeException refusal;
    volatile IErrorHandler errorHandler;
    /** Number of motions after which further motions are refused. */
    volatile int refuseAfter = Integer.MAX_VALUE;
    volatile Runnable onCancel;

    /** A motion in progress. */
    final class Container implements IMotionContainer {
        final String what;
        private final IMotionContainerListener listener;
        volatile boolean isCancelled;
        private volatile boolean isFinished;
        private volatile String error;

        Container(String what, IMotionContainerListener listener) {
            this.what = what;
            this.listener = listener;
        }

        void finish(String why) {
            error = why;
            isFinished = true;
            listener.containerFinished(this);
        }

        @Override
        public void cancel() {
            isCancelled = true;
            if (onCancel != null) {
                onCancel.run();
            }
            finish("cancelled");
        }

        @Override
        public boolean isFinished() {
            return isFinished;
        }

        @Override
        public boolean hasError() {
            return error != null;
        }

        @Override
        public String getErrorMessage() {
            return error;
        }
    }

    /** A TCP. */
    final class Point implements ObjectFrame {
        private final String name;
        private final double z;

        Point(String name, double z) {
            this.name = name;
            this.z = z;
        }

        @Override
        public IMotionContainer moveAsync(IMotion motion, IMotionContainerListener listener) {
            return FakeRobot.this.move(name, motion, listener);
        }

        @Override
        public double getX() {
            return 0;
        }

        @Override
        public double getY() {
            return 0;
        }

        @Override
        public double getZ() {
            return z;
        }

        @Override
        public double getAlphaRad() {
            return 0;
        }

        @Override
        public double getBetaRad() {
            return 0;
        }

        @Override
        public double getGammaRad() {
            return 0;
        }
    }

    FakeRobot() {
        points.put("flange", new Point("flange", 1000));
        points.put("root", new Point("root", 0));
        points.put("gripper", new Point("gripper", 1120));
        points.put("/left", new Point("left", 1130));
    }

    private IMotionContainer move(String point, IMotion motion, IMotionContainerListener listener) {
        if (containers.size() >= refuseAfter) {
            throw new CommandInvalidException("workspace error");
        }
        if (refusal != null) {
            throw refusal;
        }
        Container container = new Container(point + ": " + motion, listener);
        containers.add(container);
        return container;
    }

    @Override
    public IMotionContainer moveAsync(IMotion motion, IMotionContainerListener listener) {
        return move("robot", motion, listener);
    }

    @Override
    public boolean isReadyToMove() {
        return isReady;
    }

    @Override
    public boolean isMastered() {
        return isMastered;
    }

    @Override
    public OperationMode getOperationMode() {
        return mode;
    }

    @Override
    public ISafetyState getSafetyState() {
        return new ISafetyState() {
            @Override
            public SafetyStopType getSafetyStopSignal() {
                return stop;
            }
        };
    }

    @Override
    public Controller getController() {
        return new Controller() {
            @Override
            public String getName() {
                return "cabinet";
            }

            @Override
            public IExecutionService getExecutionService() {
                return new SunriseExecutionService() {
                    @Override
                    public boolean isPaused() {
                        return isPaused;
                    }
                };
            }
        };
    }

    @Override
    public JointLimits getJointLimits() {
        return new JointLimits() {
            @Override
            public JointPosition getMaxJointPosition() {
                return new JointPosition(3, 2, 3, 2, 3, 2, 3);
            }

            @Override
            public JointPosition getMinJointPosition() {
                return new JointPosition(-3, -2, -3, -2, -3, -2, -3);
            }
        };
    }

    @Override
    public JointPosition getCurrentJointPosition() {
        return joints;
    }

    @Override
    public TorqueSensorData getExternalTorque() {
        return new TorqueSensorData() {
            @Override
            public double[] getTorqueValues() {
                return new double[] {1, 2, 3, 4, 5, 6, 7};
            }
        };
    }

    @Override
    public ObjectFrame getFlange() {
        return points.get("flange");
    }

    @Override
    public ObjectFrame getRootFrame() {
        return points.get("root");
    }

    @Override
    public Frame getCurrentCartesianPosition(ObjectFrame frame) {
        return new Frame(getRootFrame(), frame.getX(), frame.getY(), frame.getZ(), 0, 0, 0);
    }

    @Override
    public String toString() {
        return "robot";
    }

    @Override
    public double getApplicationOverride() {
        return 0.8;
    }

    @Override
    public void registerMoveAsyncErrorHandler(IErrorHandler handler) {
        errorHandler = handler;
    }

    @Override
    public Tool createFromTemplate(String name) {
        return new Tool() {
            @Override
            public void attachTo(ObjectFrame frame) {
                points.put("attached", (Point) frame);
            }

            @Override
            public ObjectFrame getDefaultMotionFrame() {
                return points.get("gripper");
            }

            @Override
            public ObjectFrame getFrame(String path) {
                if (!points.containsKey(path)) {
                    throw new IllegalArgumentException("no frame " + path);
                }
                return points.get(path);
            }
        };
    }
}
