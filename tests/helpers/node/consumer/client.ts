/** The story in a page. */
import { story } from "./story.js";

Object.assign(window, { story });
