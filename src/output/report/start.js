// Puts the parts together; what is chosen first is the worst hinge.

shown.loads = loadsAsMade();
textParts();
themeButton();
buildSheet();
buildSpace();
buildTable();
onLoads.push(drawHistograms);
onPick.push(showDetail);
onLoads.push(() => picked !== null && showDetail(picked));
drawHistograms();
drawStages();
showMap();
buildWhatIf();
if (COUNT > 0) pick(table.order[0], "start");
else byId("detail").hidden = true;
