package iiwasim.program;

/** The point of the arm that a motion moves: of a tool, or the bare flange. */
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

    /** The name of the tool; {@link #FLANGE} for none. */
    public String tool() {
        return tool;
    }

    /** The name of a further TCP of the tool; null for its own. */
    public String tip() {
        return tip;
    }

    /** Where it is in the flange's frame. */
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
