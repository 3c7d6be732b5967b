package iiwasim.program;

/** TCP of a motion: of a tool, or the bare flange. */
public final class Tcp {
    /** The name of the bare flange. */
    public static final String FLANGE = "flange";

    private final String tool;
    private final String tip;
    private final Pose pose;

    Tcp(String tool, String tip, Pose pose) {
        this.tool = tool;
        this.tip = tip;
        this.pose = pose;
    }

    /** Name of the tool; {@link #FLANGE} without a tool. */
    public String tool() {
        return tool;
    }

    /** Name of a further TCP of the tool; null for the default TCP. */
    public String tip() {
        return tip;
    }

    /** Pose in the flange frame. */
    public Pose pose() {
        return pose;
    }

    public boolean isFlange() {
        return tool.equals(FLANGE);
    }

    @Override
    public String toString() {
        return tip == null ? tool : tool + "/" + tip;
    }
}
