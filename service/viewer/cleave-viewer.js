/* Cleave, MIT. Contains three.js, copyright three.js authors, MIT. */
import{b as a,c as b}from"./viewer-2.js";import"./viewer.js";export{b as CleaveViewer,a as nodeOfPart};
